"""Reads flatbuffers: just enough of the format for a .tflite file.

A table starts with a signed offset back to its vtable; the vtable holds one 16-bit offset per field, 0 where the field
is absent. See "FlatBuffer internals" in the FlatBuffers documentation.
"""

import struct


class Table:
    """One flatbuffer table. Fields are addressed by their index in the schema."""

    def __init__(self, buffer, position):
        self._buffer = buffer
        self._position = position
        self._vtable = position - struct.unpack_from("<i", buffer, position)[0]
        self._vtable_size = struct.unpack_from("<H", buffer, self._vtable)[0]

    @classmethod
    def root(cls, buffer):
        """The table at the beginning of the file."""
        return cls(buffer, struct.unpack_from("<I", buffer, 0)[0])

    def scalar(self, field, kind, default=0):
        """A number; `kind` is its `struct` letter."""
        offset = self._offset(field)
        return struct.unpack_from("<" + kind, self._buffer, self._position + offset)[0] if offset else default

    def table(self, field):
        """A nested table, or None."""
        position = self._target(field)
        return None if position is None else Table(self._buffer, position)

    def tables(self, field):
        """A vector of tables."""
        start, count = self._vector(field)
        entries = range(start, start + 4 * count, 4)
        return [Table(self._buffer, at + struct.unpack_from("<I", self._buffer, at)[0]) for at in entries]

    def numbers(self, field, kind):
        """A vector of numbers; `kind` is their `struct` letter."""
        start, count = self._vector(field)
        return list(struct.unpack_from("<%d%s" % (count, kind), self._buffer, start)) if count else []

    def raw(self, field):
        """A vector of bytes or a string."""
        start, count = self._vector(field)
        return bytes(self._buffer[start : start + count])

    def _offset(self, field):
        entry = 4 + 2 * field
        return struct.unpack_from("<H", self._buffer, self._vtable + entry)[0] if entry < self._vtable_size else 0

    def _target(self, field):
        offset = self._offset(field)
        if not offset:
            return None
        at = self._position + offset
        return at + struct.unpack_from("<I", self._buffer, at)[0]

    def _vector(self, field):
        at = self._target(field)
        return (0, 0) if at is None else (at + 4, struct.unpack_from("<I", self._buffer, at)[0])
