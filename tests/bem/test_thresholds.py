"""bem/THRESHOLDS.md lists the numerical constants of bem on which a result may depend, with the values that they have.

Constants that are computed from others, or from the precision of numbers, need no row; nor do those whose comment
begins with a word that says why no result depends on them.
"""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "bem" / "THRESHOLDS.md").read_text("utf-8")
MODULES = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "bem").rglob("*.py"))
UNNAMED = "Numbers in functions"
ROWS = 75  # at most: a new constant is derived, or takes the place of another
REASONS = re.findall(r"^\| (\w+) \|", PAGE.partition("| word |")[2].partition("\n\n")[0], flags=re.MULTILINE)
NUMERIC = (ast.Constant, ast.Tuple, ast.UnaryOp, ast.BinOp, ast.operator, ast.unaryop, ast.Name, ast.Attribute)
ARITHMETIC = {"float", "linspace", "finfo"}


def is_numeric(value: ast.expr) -> bool:
    """Whether an expression is made of at least one number, arithmetic, and names of other constants."""
    parts = [part for part in ast.walk(value) if not isinstance(part, ast.expr_context)]
    calls = [part.func for part in parts if isinstance(part, ast.Call)]
    constants = [part.value for part in parts if isinstance(part, ast.Constant)]
    return (
        all(isinstance(part, (*NUMERIC, ast.Call)) for part in parts)
        and {getattr(call, "attr", getattr(call, "id", "")) for call in calls} <= ARITHMETIC
        and bool(constants)
        and all(isinstance(constant, int | float) for constant in constants)
    )


def is_derived(value: ast.expr) -> bool:
    """Whether an expression contains another constant, or what NumPy says of the precision of numbers."""
    names = {getattr(part, "id", "") for part in ast.walk(value)} - {"TWO_PI"}
    return any(name.isupper() for name in names) or "finfo" in ast.unparse(value)


def constants_of(source: str) -> dict[str, str]:
    """Numerical constants in capitals at the top level of a module, but 2 pi; values in normal form."""
    found: dict[str, str] = {}
    for node in ast.parse(source).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        if source.splitlines()[(node.end_lineno or 1) - 1].partition("  # ")[2].partition(":")[0] in REASONS:
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        for target in targets:
            several = isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple)
            pairs = zip(target.elts, node.value.elts, strict=True) if several else [(target, node.value)]
            found |= {
                name.id: ast.unparse(value)
                for name, value in pairs
                if name.id.isupper() and is_numeric(value) and not is_derived(value)
            }
    found.pop("TWO_PI", None)
    return found


def listed() -> dict[str, dict[str, str]]:
    """Constants on the page, module by module."""
    found: dict[str, dict[str, str]] = {}
    for section in re.split(r"^### ", PAGE.partition(f"## {UNNAMED}")[0], flags=re.MULTILINE)[1:]:
        module = section.split("`")[1]
        rows = found.setdefault(module, {})
        for row in re.findall(r"^\| (`\w+`(?:, `\w+`)*) \| `(.*?)` \|", section, flags=re.MULTILINE):
            names, value = re.findall(r"\w+", row[0]), ast.parse(row[1], mode="eval").body
            values = value.elts if len(names) > 1 and isinstance(value, ast.Tuple) else [value]
            rows |= dict(zip(names, map(ast.unparse, values), strict=True))
    return found


@pytest.mark.parametrize("module", MODULES)
def test_constants_are_on_the_page(module):
    assert listed().get(module, {}) == constants_of((ROOT / module).read_text("utf-8"))


def test_the_page_does_not_grow():
    rows = [line for line in PAGE.partition("## ")[2].splitlines() if line.startswith("| ")]
    heads = [row for row in rows if row.startswith(("| ---", "| constant |", "| where |"))]
    assert len(rows) - len(heads) <= ROWS
    assert [row for row in rows if row.startswith("| |")] == []


def test_modules_on_the_page_exist():
    assert set(listed()) <= set(MODULES)


def test_a_name_in_capitals_is_defined_once():
    """One name for one thing, one thing for one name."""
    places: dict[str, list[str]] = {}
    for module in MODULES:
        tree = ast.parse((ROOT / module).read_text("utf-8"))
        names = [part for node in tree.body if isinstance(node, ast.Assign) for part in ast.walk(node)]
        stored = (part for part in names if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store))
        for name in {part.id for part in stored if part.id.isupper()}:
            places.setdefault(name, []).append(module)
    assert {name: modules for name, modules in places.items() if len(modules) > 1} == {}
