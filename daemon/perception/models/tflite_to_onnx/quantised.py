"""Translates a .tflite graph to an ONNX graph that computes most convolutions with bytes.

Pictures are rounded to 8 bits between the least and the greatest value that calibration has seen, and weights to 7 bits and a sign, with a
scale of its own for each channel of the output. Processors without instructions for bytes add two products in 16 bits: with 8 bits of weight
that would overflow, and with 7 it cannot, so every processor computes the same.

In ONNX a rounded number is written as a QuantizeLinear and a DequantizeLinear after it; ONNX Runtime merges them into the operators.
"""

import array
import struct

from . import onnx
from .graph import Graph, permuted, translate

# Convolutions at the beginning that stay as they are: they see the finest detail, and nine tenths of the error came from them.
EXACT = 6
# The last one is left out. Nobody rounds what it gives, so ONNX Runtime would take rounded weights back to floats in every run, for a tenth of the
# time.
LAST = 47
_MAX_WEIGHT = 64
_MAX_BYTE = 255
_MAX_BIAS = 2**30


def quantise(tflite, ranges):
    """The bytes of the rounded ONNX model of a .tflite model; `ranges` has the least and the greatest value of each picture by its name."""
    return translate(tflite, lambda model: _Quantised(model, ranges))


def observe(tflite):
    """The bytes of the ONNX model whose outputs are the pictures between its convolutions as well."""
    return translate(tflite, _Observed)


class _Observed(Graph):
    def serialise(self):
        self.outputs = list(self.outputs)
        for index, name in self.pictures.items():
            if index not in self.inputs and index not in self.outputs:
                self.names[index] = name
                # The value exists under this name: it only has to be declared.
                batch, height, width, channels = self.shapes[index]
                self.shapes[index] = [batch, channels, height, width]
                self.outputs.append(index)
        return super().serialise()


class _Quantised(Graph):
    def __init__(self, model, ranges):
        self.ranges = ranges
        self.rounded = {}  # tensor -> ONNX name of its rounded version
        self.convolutions = 0
        super().__init__(model)

    def _terms(self, inputs, weight_order):
        self.convolutions += 1
        if self.convolutions <= EXACT:
            return super()._terms(inputs, weight_order)
        if self.convolutions == LAST:
            return [self._rounded(inputs[0]), *self._weights(inputs, weight_order)]
        scale, _ = self._scale(inputs[0])
        # A channel of next to no weight has a scale that lets its bias fit into 32 bits.
        bias, _ = self._floats(inputs[2])
        least_scales = [abs(value) / scale / _MAX_BIAS for value in bias]
        weights, weight_scales = self._rounded_weights(inputs[1], weight_order, least_scales)
        bias = self._rounded_bias(inputs[2], [scale * weight_scale for weight_scale in weight_scales])
        return [self._rounded(inputs[0]), weights, bias]

    def _addend(self, index):
        return self._rounded(index)

    def _scale(self, index):
        """The step between two bytes of a picture, and the byte that stands for 0."""
        least, greatest = self.ranges[self.pictures[index]]
        least, greatest = min(least, 0.0), max(greatest, 0.0)
        (scale,) = struct.unpack("<f", struct.pack("<f", (greatest - least) / _MAX_BYTE))
        return scale, round(-least / scale)

    def _rounded(self, index):
        if index not in self.rounded:
            name = self.pictures[index]
            scale, zero = self._scale(index)
            self.initializers.append(onnx.tensor(name + "s", [], onnx.FLOAT, struct.pack("<f", scale)))
            self.initializers.append(onnx.tensor(name + "z", [], onnx.UINT8, struct.pack("<B", zero)))
            self._node("QuantizeLinear", [name, name + "s", name + "z"], name + "u")
            self.rounded[index] = self._node("DequantizeLinear", [name + "u", name + "s", name + "z"], name + "d")
        return self.rounded[index]

    def _channels(self, kind, element_type, name, values, shape, scales):
        """A constant whose first axis has a scale for each channel."""
        self.initializers.append(onnx.tensor(name + "v", shape, element_type, array.array(kind, values).tobytes()))
        self.initializers.append(onnx.tensor(name + "w", [len(scales)], onnx.FLOAT, struct.pack("<%df" % len(scales), *scales)))
        zeros = array.array(kind, [0] * len(scales)).tobytes()
        self.initializers.append(onnx.tensor(name + "y", [len(scales)], element_type, zeros))
        return self._node("DequantizeLinear", [name + "v", name + "w", name + "y"], name, axis=0)

    def _rounded_weights(self, index, order, least_scales):
        values, stored = self._floats(index)
        shape = [self.shapes[stored][axis] for axis in order]
        values = permuted(values, self.shapes[stored], order)
        channels, length = shape[0], len(values) // shape[0]
        rows = [values[channel * length : (channel + 1) * length] for channel in range(channels)]
        # A channel without weight and bias has any scale.
        scales = [max(max(map(abs, row)) / _MAX_WEIGHT, least) or 1.0 for row, least in zip(rows, least_scales)]
        scales = struct.unpack("<%df" % channels, struct.pack("<%df" % channels, *scales))
        rounded = [max(-_MAX_WEIGHT, min(_MAX_WEIGHT, round(value / scale))) for row, scale in zip(rows, scales) for value in row]
        return self._channels("b", onnx.INT8, "w%d" % index, rounded, shape, scales), scales

    def _rounded_bias(self, index, scales):
        values, _ = self._floats(index)
        rounded = [round(value / scale) for value, scale in zip(values, scales)]
        return self._channels("i", onnx.INT32, "b%d" % index, rounded, [len(rounded)], scales)
