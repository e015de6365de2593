from bem.geometry.arrays import FloatArray, IntArray

def stress_intensity_jacobian(
    half_width: FloatArray, modes: IntArray, intensity: FloatArray, compliance: FloatArray, slope: FloatArray
) -> FloatArray: ...
