"""Translates the operators of a .tflite graph to ONNX.

Inputs and outputs keep TensorFlow's NHWC layout and their names; inside the graph pictures are NCHW, as ONNX requires.
Weights are stored as float16 with a DEQUANTIZE after them; they become float32 constants.
"""

import array
import struct

from . import onnx
from .flatbuffer import Table

# BuiltinOperator of the TensorFlow Lite schema.
_OPERATORS = {
    0: "ADD",
    2: "CONCATENATION",
    3: "CONV_2D",
    4: "DEPTHWISE_CONV_2D",
    6: "DEQUANTIZE",
    9: "FULLY_CONNECTED",
    14: "LOGISTIC",
    17: "MAX_POOL_2D",
    22: "RESHAPE",
    23: "RESIZE_BILINEAR",
    34: "PAD",
    40: "MEAN",
    54: "PRELU",
}
# TensorType, ActivationFunctionType and Padding of the schema.
_FLOAT32, _FLOAT16 = 0, 1
_NO_ACTIVATION, _RELU, _RELU6 = 0, 1, 3
_SAME = 0
_NHWC_TO_NCHW = [0, 3, 1, 2]
_NCHW_TO_NHWC = [0, 2, 3, 1]


class ConversionError(Exception):
    """The file is no .tflite model, or uses something that the converter does not support."""


def convert(tflite):
    """The bytes of the ONNX model that computes what the .tflite model with these bytes computes."""
    return translate(tflite, Graph)


def translate(tflite, graph):
    """The bytes of the ONNX model that a class of graphs makes of a .tflite model with these bytes."""
    if tflite[4:8] != b"TFL3":
        raise ConversionError("it is not a TensorFlow Lite model (no TFL3 mark)")
    try:
        return graph(Table.root(tflite)).serialise()
    except (struct.error, IndexError) as error:
        raise ConversionError("the TensorFlow Lite model is cut short or damaged (%s)" % error) from error


def _require(condition, what):
    if not condition:
        raise ConversionError("unsupported: " + what)


def permuted(data, shape, order):
    """Row-major `data` of `shape` with its axes in another order, row-major again."""
    strides = [1] * len(shape)
    for axis in range(len(shape) - 2, -1, -1):
        strides[axis] = strides[axis + 1] * shape[axis + 1]
    indices = [0]
    for axis in order:
        indices = [base + step * strides[axis] for base in indices for step in range(shape[axis])]
    return array.array(data.typecode, [data[index] for index in indices])


def _same_padding(size, kernel, stride, dilation=1):
    """TensorFlow's SAME padding along one axis: (before, after); an odd pixel goes after."""
    total = max((-(-size // stride) - 1) * stride + (kernel - 1) * dilation + 1 - size, 0)
    return total // 2, total - total // 2


class Graph:
    """A .tflite graph and the ONNX graph that it becomes."""

    def __init__(self, model):
        codes = [max(code.scalar(0, "b"), code.scalar(3, "i")) for code in model.tables(1)]
        subgraphs = model.tables(2)
        _require(len(subgraphs) == 1, "%d subgraphs" % len(subgraphs))
        subgraph, buffers = subgraphs[0], model.tables(4)

        tensors = subgraph.tables(0)
        self.shapes = [tensor.numbers(0, "i") for tensor in tensors]
        self.types = [tensor.scalar(1, "b") for tensor in tensors]
        self.names = [tensor.raw(3).decode() for tensor in tensors]
        self.data = [buffers[tensor.scalar(2, "I")].raw(0) for tensor in tensors]
        self.inputs, self.outputs = subgraph.numbers(1, "i"), subgraph.numbers(2, "i")

        self.nodes, self.initializers = [], []
        self.pictures = {}  # tensor -> ONNX name of its NCHW version
        self.stored_as = {}  # dequantized tensor -> the float16 constant it comes from
        self.constants = {}  # (constant, shape, order) -> ONNX name
        self.has_clip_bounds = False

        for index in self.inputs:
            self.pictures[index] = self._node("Transpose", [self.names[index]], "t%d" % index, perm=_NHWC_TO_NCHW)
        for operator in subgraph.tables(3):
            code = codes[operator.scalar(0, "I")]
            _require(code in _OPERATORS, "operator code %d" % code)
            translate = getattr(self, "_" + _OPERATORS[code].lower())
            translate(operator.numbers(1, "i"), operator.numbers(2, "i")[0], operator.table(4))
        for index in self.outputs:
            self._node("Identity", [self._nhwc(index)], self.names[index])

    def serialise(self):
        return onnx.model(
            self.nodes,
            self.initializers,
            [onnx.float_value_info(self.names[index], self.shapes[index]) for index in self.inputs],
            [onnx.float_value_info(self.names[index], self.shapes[index]) for index in self.outputs],
        )

    # Building blocks

    def _node(self, operator, inputs, output, **attributes):
        self.nodes.append(onnx.node(operator, inputs, [output], attributes))
        return output

    def _output(self, index):
        """Declares the ONNX name of the tensor that an operator computes."""
        if len(self.shapes[index]) != 4:
            return "a%d" % index
        self.pictures[index] = "t%d" % index
        return self.pictures[index]

    def _nhwc(self, index):
        """The tensor in TensorFlow's layout."""
        if index not in self.pictures:
            return "a%d" % index
        return self._node("Transpose", [self.pictures[index]], "n%d" % index, perm=_NCHW_TO_NHWC)

    def _integers(self, index):
        data = self.data[index]
        return list(struct.unpack("<%di" % (len(data) // 4), data))

    def _int64(self, name, values):
        self.initializers.append(onnx.tensor(name, [len(values)], onnx.INT64, struct.pack("<%dq" % len(values), *values)))
        return name

    def _floats(self, index):
        """The values of a constant, and the tensor that stores them."""
        stored = self.stored_as.get(index, index)
        kind = {_FLOAT16: "e", _FLOAT32: "f"}.get(self.types[stored])
        _require(kind and self.data[stored], "weights %s that are not a float constant" % self.names[index])
        data = self.data[stored]
        return array.array("f", struct.unpack("<%d%s" % (len(data) // struct.calcsize(kind), kind), data)), stored

    def _constant(self, index, shape=None, order=None):
        """A float constant, its axes put in `order`, then seen as `shape`."""
        values, stored = self._floats(index)
        key = (stored, tuple(shape or ()), tuple(order or ()))
        if key not in self.constants:
            # The clip bounds count as one. The names are part of the bytes, and therefore of the checksums.
            name = "c%d_%d" % (stored, len(self.constants) + self.has_clip_bounds)
            own_shape = self.shapes[stored]
            if order:
                values = permuted(values, own_shape, order)
                own_shape = [own_shape[axis] for axis in order]
            self.initializers.append(onnx.tensor(name, shape or own_shape, onnx.FLOAT, values.tobytes()))
            self.constants[key] = name
        return self.constants[key]

    def _weights(self, inputs, order=None):
        """Names of the weights and, where there is one, of the bias."""
        names = [self._constant(inputs[1], order=order)]
        if len(inputs) > 2 and inputs[2] >= 0:
            names.append(self._constant(inputs[2]))
        return names

    def _activated(self, code, value, output):
        """The activation that TensorFlow Lite fuses into an operator."""
        if code == _RELU6:
            if not self.has_clip_bounds:
                for name, bound in (("zero", 0.0), ("six", 6.0)):
                    self.initializers.append(onnx.tensor(name, [], onnx.FLOAT, struct.pack("<f", bound)))
                self.has_clip_bounds = True
            return self._node("Clip", [value, "zero", "six"], output)
        _require(code in (_NO_ACTIVATION, _RELU), "fused activation %d" % code)
        return self._node("Relu" if code == _RELU else "Identity", [value], output)

    # Operators: inputs and output are tensor indices, options is the operator's option table

    def _dequantize(self, inputs, output, _options):
        _require(self.types[inputs[0]] == _FLOAT16 and self.data[inputs[0]], "DEQUANTIZE of other than float16 weights")
        self.stored_as[output] = inputs[0]

    def _conv_2d(self, inputs, output, options):
        self._convolution(inputs, output, options, 1, _NHWC_TO_NCHW, activation_field=3)

    def _depthwise_conv_2d(self, inputs, output, options):
        self._convolution(inputs, output, options, self.shapes[inputs[0]][3], [3, 0, 1, 2], activation_field=4)

    def _convolution(self, inputs, output, options, groups, weight_order, activation_field):
        name = self._output(output)
        _, height, width, _ = self.shapes[inputs[0]]
        _, kernel_height, kernel_width, _ = self.shapes[inputs[1]]
        stride_width, stride_height = options.scalar(1, "i"), options.scalar(2, "i")
        dilation_width = options.scalar(activation_field + 1, "i", 1)
        dilation_height = options.scalar(activation_field + 2, "i", 1)
        pads = [0, 0, 0, 0]
        if options.scalar(0, "b") == _SAME:
            top, bottom = _same_padding(height, kernel_height, stride_height, dilation_height)
            left, right = _same_padding(width, kernel_width, stride_width, dilation_width)
            pads = [top, left, bottom, right]
        self._node(
            "Conv",
            self._terms(inputs, weight_order),
            name + "p",
            group=groups,
            kernel_shape=[kernel_height, kernel_width],
            strides=[stride_height, stride_width],
            dilations=[dilation_height, dilation_width],
            pads=pads,
        )
        self._activated(options.scalar(activation_field, "b"), name + "p", name)

    def _terms(self, inputs, weight_order):
        """The names of what a convolution takes: picture, weights and, where there is one, bias."""
        return [self.pictures[inputs[0]], *self._weights(inputs, weight_order)]

    def _addend(self, index):
        """The name of a picture that is added to another one."""
        return self.pictures[index]

    def _prelu(self, inputs, output, _options):
        # As a x + (1 - a) relu(x): ONNX Runtime's PRelu takes 40 % of the palm model's time and breaks its blocked layout.
        name, picture = self._output(output), self.pictures[inputs[0]]
        shape = [self.shapes[inputs[0]][3], 1, 1]
        slope = self._constant(inputs[1], shape=shape)
        values, _ = self._floats(inputs[1])
        rest = struct.pack("<%df" % len(values), *[1.0 - value for value in values])
        self.initializers.append(onnx.tensor(name + "q", shape, onnx.FLOAT, rest))
        self._node("Relu", [picture], name + "r")
        self._node("Mul", [name + "r", name + "q"], name + "k")
        self._node("Mul", [picture, slope], name + "j")
        self._node("Add", [name + "j", name + "k"], name)

    def _add(self, inputs, output, options):
        _require(self.shapes[inputs[0]] == self.shapes[inputs[1]], "ADD that broadcasts")
        name = self._output(output)
        self._node("Add", [self._addend(index) for index in inputs], name + "p")
        self._activated(options.scalar(0, "b") if options else _NO_ACTIVATION, name + "p", name)

    def _max_pool_2d(self, inputs, output, options):
        name = self._output(output)
        _, height, width, _ = self.shapes[inputs[0]]
        stride_width, stride_height, kernel_width, kernel_height = (options.scalar(field, "i") for field in (1, 2, 3, 4))
        pads = [0, 0, 0, 0]
        if options.scalar(0, "b") == _SAME:
            top, bottom = _same_padding(height, kernel_height, stride_height)
            left, right = _same_padding(width, kernel_width, stride_width)
            pads = [top, left, bottom, right]
        self._node(
            "MaxPool",
            [self.pictures[inputs[0]]],
            name + "p",
            kernel_shape=[kernel_height, kernel_width],
            strides=[stride_height, stride_width],
            pads=pads,
        )
        self._activated(options.scalar(5, "b"), name + "p", name)

    def _pad(self, inputs, output, _options):
        name, amounts = self._output(output), self._integers(inputs[1])
        before, after = amounts[0::2], amounts[1::2]
        pads = [before[axis] for axis in _NHWC_TO_NCHW] + [after[axis] for axis in _NHWC_TO_NCHW]
        self._node("Pad", [self.pictures[inputs[0]], self._int64(name + "pads", pads)], name, mode="constant")

    def _resize_bilinear(self, inputs, output, options):
        name = self._output(output)
        batch, height, width, channels = self.shapes[output]
        mode = "align_corners" if options.scalar(2, "b") else "half_pixel" if options.scalar(3, "b") else "asymmetric"
        size = self._int64(name + "sz", [batch, channels, height, width])
        picture = self.pictures[inputs[0]]
        self._node("Resize", [picture, "", "", size], name, mode="linear", coordinate_transformation_mode=mode)

    def _reshape(self, inputs, output, _options):
        name = self._output(output)
        self._node("Reshape", [self._nhwc(inputs[0]), self._int64(name + "shape", self.shapes[output])], name)

    def _concatenation(self, inputs, output, options):
        _require(all(len(self.shapes[index]) == 3 for index in inputs), "CONCATENATION of other than three axes")
        name = self._output(output)
        self._node("Concat", [self._nhwc(index) for index in inputs], name, axis=options.scalar(0, "i"))

    def _mean(self, inputs, output, _options):
        _require(sorted(self._integers(inputs[1])) == [1, 2], "MEAN over other axes than height and width")
        name, flat = self._output(output), len(self.shapes[output]) == 2
        pooled = self._node("GlobalAveragePool", [self.pictures[inputs[0]]], name + "g" if flat else name)
        if flat:
            self._node("Reshape", [pooled, self._int64(name + "shape", self.shapes[output])], name)

    def _fully_connected(self, inputs, output, options):
        name = self._output(output)
        if inputs[0] in self.pictures:
            _require(self.shapes[inputs[0]][1:3] == [1, 1], "FULLY_CONNECTED on a picture")
            rows = self._node("Flatten", [self.pictures[inputs[0]]], name + "f", axis=1)
        else:
            rows = self._nhwc(inputs[0])
        self._node("Gemm", [rows, *self._weights(inputs)], name + "p", transB=1)
        self._activated(options.scalar(0, "b"), name + "p", name)

    def _logistic(self, inputs, output, _options):
        name = self._output(output)
        self._node("Sigmoid", [self._nhwc(inputs[0])], name)
