from bem.geometry.arrays import FloatArray, IntArray

def stress_intensity_jacobian(
    half_width: FloatArray, modes: IntArray, intensity: FloatArray, compliance: FloatArray, slope: FloatArray
) -> FloatArray: ...
def edge_fields(
    half_width: FloatArray,
    modes: IntArray,
    intensity: FloatArray,
    jacobian: FloatArray,
    s: FloatArray,
    slopes: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]: ...
