from bem.geometry.arrays import FloatArray, IntArray

def sizes(
    left: FloatArray,
    right: FloatArray,
    tolerance: float,
    max_order: float,
    least: FloatArray,
    of_modes: IntArray,
    of_nodes: IntArray,
) -> tuple[IntArray, IntArray]: ...
def right_hand_sides(
    table: FloatArray,
    center: FloatArray,
    half_width: FloatArray,
    level: float,
    nodes: IntArray,
    sampling: FloatArray,
    at_nodes: IntArray,
    modes: IntArray,
    coupled: FloatArray,
    at_modes: IntArray,
    series: FloatArray,
    most_transformed: int,
) -> tuple[FloatArray, FloatArray, FloatArray, float]: ...
def all_charges(
    modes: IntArray, coupled: FloatArray, at: IntArray, series: FloatArray, skeleton: FloatArray
) -> FloatArray: ...
