"""Writes ONNX models: the protobuf messages of onnx.proto3 that the converter needs.

The numbers are the field numbers of onnx.proto3.
"""

import struct

FLOAT = 1
UINT8 = 2
INT8 = 3
INT32 = 6
INT64 = 7

# Opset 13 is the smallest that has every operator used here. It came with IR version 7; ONNX 1.10 to 1.12 wrote 8.
OPSET = 13
IR_VERSION = 8
# Part of the bytes, and therefore of the checksums.
PRODUCER = "tflite2onnx_stdlib"

_ATTRIBUTE_FLOAT, _ATTRIBUTE_INT, _ATTRIBUTE_STRING, _ATTRIBUTE_INTS = 1, 2, 3, 7


def _varint(number):
    number &= (1 << 64) - 1
    out = bytearray()
    while number > 127:
        out.append(number & 127 | 128)
        number >>= 7
    out.append(number)
    return bytes(out)


def _int(field, number):
    return _varint(field << 3) + _varint(number)


def _bytes(field, data):
    if isinstance(data, str):
        data = data.encode()
    return _varint(field << 3 | 2) + _varint(len(data)) + data


def _float(field, number):
    return _varint(field << 3 | 5) + struct.pack("<f", number)


def _attribute(name, value):
    if isinstance(value, float):
        return _bytes(1, name) + _float(2, value) + _int(20, _ATTRIBUTE_FLOAT)
    if isinstance(value, int):
        return _bytes(1, name) + _int(3, value) + _int(20, _ATTRIBUTE_INT)
    if isinstance(value, str):
        return _bytes(1, name) + _bytes(4, value) + _int(20, _ATTRIBUTE_STRING)
    return _bytes(1, name) + b"".join(_int(8, item) for item in value) + _int(20, _ATTRIBUTE_INTS)


def node(operator, inputs, outputs, attributes):
    """A NodeProto."""
    return (
        b"".join(_bytes(1, name) for name in inputs)
        + b"".join(_bytes(2, name) for name in outputs)
        + _bytes(3, outputs[0] + "_" + operator)
        + _bytes(4, operator)
        + b"".join(_bytes(5, _attribute(name, value)) for name, value in attributes.items())
    )


def tensor(name, shape, element_type, raw):
    """A TensorProto with raw little-endian data."""
    return b"".join(_int(1, size) for size in shape) + _int(2, element_type) + _bytes(8, name) + _bytes(9, raw)


def float_value_info(name, shape):
    """A ValueInfoProto of a float tensor."""
    dimensions = b"".join(_bytes(1, _int(1, size)) for size in shape)
    return _bytes(1, name) + _bytes(2, _bytes(1, _int(1, FLOAT) + _bytes(2, dimensions)))


def model(nodes, initializers, inputs, outputs):
    """A ModelProto; every argument is a list of serialised messages."""
    graph = (
        b"".join(_bytes(1, item) for item in nodes)
        + _bytes(2, "g")
        + b"".join(_bytes(5, item) for item in initializers)
        + b"".join(_bytes(11, item) for item in inputs)
        + b"".join(_bytes(12, item) for item in outputs)
    )
    opset = _bytes(1, "") + _int(2, OPSET)
    return _int(1, IR_VERSION) + _bytes(2, PRODUCER) + _bytes(7, graph) + _bytes(8, opset)
