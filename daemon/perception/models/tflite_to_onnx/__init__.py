"""Convert the MediaPipe hand models from TensorFlow Lite to ONNX with the Python standard library alone.

`flatbuffer` reads the .tflite file, `graph` translates its operators, `quantised` rounds what
they compute with, `onnx` writes the result. Only the operators
that these models use are supported; any other is refused by its name. The same input gives the same bytes everywhere.
"""

from .graph import ConversionError, convert
from .quantised import observe, quantise

__all__ = ["ConversionError", "convert", "observe", "quantise"]
