from bem.geometry.arrays import FloatArray, IntArray

def splits(
    x: FloatArray, left: FloatArray, right: FloatArray, starts: IntArray, largest: int
) -> tuple[IntArray, FloatArray]: ...
def solved(
    x: FloatArray,
    half_width: FloatArray,
    starts: IntArray,
    tables: FloatArray,
    at: IntArray,
    columns: FloatArray,
    cuts: IntArray,
    arcs: FloatArray,
    ranges: list[tuple[FloatArray, int, FloatArray] | None],
    uniform: float,
    edge_columns: int,
    addition: FloatArray | None = None,
    fields: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray] | None: ...
