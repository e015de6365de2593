from bem.geometry.arrays import FloatArray, IntArray

def near_patches(
    center: FloatArray,
    half_width: FloatArray,
    nodes: IntArray,
    modes: IntArray,
    tables: FloatArray,
    at: IntArray,
    charges: FloatArray,
    skeleton: FloatArray,
    gap: IntArray,
    x: FloatArray,
) -> FloatArray: ...
def low_points(
    right: FloatArray,
    width: FloatArray,
    sizes: IntArray,
    counts: IntArray,
    samples: FloatArray,
    table: FloatArray,
    highest: FloatArray,
    level: float,
) -> FloatArray: ...
