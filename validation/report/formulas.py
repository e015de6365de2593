"""MathML of the formulas on the documents' pages, from the part of TeX that they use.

Letters, digits, signs, the names in `SIGNS` and `FUNCTIONS`, fractions, roots, upright text, subscripts, superscripts
and primes.  A command that is not known raises ValueError, so that a test finds it.
"""

import re
from collections.abc import Iterator

from markupsafe import Markup, escape

TOKEN = re.compile(r"\\[a-zA-Z]+|\\.|[0-9][0-9.]*|\s+|.")


def _table(pairs: str) -> dict[str, str]:
    """Return a table of names and signs that follow one another."""
    words = pairs.split()
    return dict(zip(words[::2], words[1::2], strict=True))


SIGNS = _table("""
    alpha α beta β gamma γ delta δ epsilon ϵ varepsilon ε eta η theta θ kappa κ lambda λ mu μ nu ν xi ξ pi π rho ρ
    sigma σ tau τ phi ϕ varphi φ chi χ psi ψ omega ω Delta Δ Phi Φ infty ∞ partial ∂ nabla ∇ ldots …
""")
OPERATORS = _table("""
    ast ∗ cdot · ge ≥ le ≤ ne ≠ pm ± propto ∝ sim ∼ to → sum ∑ int ∫ langle ⟨ rangle ⟩ lvert | rvert |
""")
FUNCTIONS = ("cos", "cosh", "ln", "log", "max", "min", "sin", "sinh", "tan", "tanh", "exp")
SPACES = {",": "0.17em", ";": "0.28em", " ": "0.25em", "quad": "1em", "qquad": "2em"}
SIZES = ("Bigl", "Bigr", "bigl", "bigr", "left", "right")
UNDER = ("∑", "max", "min")  # with limits below and above in displayed formulas


def formula(tex: str, *, display: bool = False) -> Markup:
    """Return a formula as MathML.

    Examples
    --------
    >>> print(formula(r"q_0^2 = \\frac{1}{\\pi}"))
    <math><msubsup><mi>q</mi><mn>0</mn><mn>2</mn></msubsup><mo>=</mo><mfrac><mrow><mn>1</mn></mrow><mrow><mi>π</mi></mrow></mfrac></math>
    """
    content = _Reader(tex).row()
    return Markup('<math display="block">' if display else "<math>") + Markup(content + "</math>")


class _Reader:
    """Reader of a formula, token by token."""

    def __init__(self, tex: str) -> None:
        self.tokens = [token for token in TOKEN.findall(tex.replace("\n", " ")) if token.strip() or token == "\\ "]
        self.place = 0

    def next(self) -> str:
        """Return the next token; an empty text at the end."""
        self.place += 1
        return self.tokens[self.place - 1] if self.place <= len(self.tokens) else ""

    def peek(self) -> str:
        """Return the token ahead."""
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def row(self, ends: tuple[str, ...] = ("",)) -> str:
        """Return everything up to one of some tokens, which stays ahead."""
        return "".join(self._scripted(ends))

    def _scripted(self, ends: tuple[str, ...]) -> Iterator[str]:
        """Yield atoms with their subscripts and superscripts."""
        while self.peek() not in ends:
            if not self.peek():
                raise ValueError("a formula ends within a group")
            atom, scripts = self.atom(), dict[str, str]()
            while (token := self.peek()) in ("_", "^", "'"):
                self.next()
                if token == "'":
                    scripts["^"] = f"<mrow>{scripts.get('^', '')}<mo>′</mo></mrow>"
                else:
                    scripts[token] = self.argument()
            if len(scripts) == 2:
                kind = "munderover" if _has_limits(atom) else "msubsup"
                yield f"<{kind}>{atom}{scripts['_']}{scripts['^']}</{kind}>"
            elif scripts:
                ((sign, script),) = scripts.items()
                below, above = ("munder", "mover") if _has_limits(atom) else ("msub", "msup")
                kind = below if sign == "_" else above
                yield f"<{kind}>{atom}{script}</{kind}>"
            else:
                yield atom

    def atom(self) -> str:
        """Return one element: a group, a command, a number, a letter or a sign."""
        token = self.next()
        if not token:
            raise ValueError("a formula ends where an argument is needed")
        if token == "{":
            content = self.row(("}",))
            self.next()
            return f"<mrow>{content}</mrow>"
        if token.startswith("\\"):
            return self._command(token[1:])
        if token[0].isdigit():
            return f"<mn>{token}</mn>"
        if token.isalpha():
            return f"<mi>{token}</mi>"
        fixed = ' stretchy="false"' if token in "()[]|" else ""
        return f"<mo{fixed}>{escape('−' if token == '-' else token)}</mo>"

    def argument(self) -> str:
        """Return the next atom; of a number its first digit alone, as in TeX."""
        token = self.peek()
        if token[:1].isdigit() and len(token) > 1:
            self.tokens[self.place] = token[1:]
            return f"<mn>{token[0]}</mn>"
        return self.atom()

    def _command(self, name: str) -> str:
        """Return the element of a command."""
        if name in SIGNS:
            return f"<mi>{SIGNS[name]}</mi>"
        if name in OPERATORS:
            return f"<mo>{OPERATORS[name]}</mo>"
        if name in FUNCTIONS:
            return f"<mi>{name}</mi><mspace width='0.17em'/>" if self.peek() not in ("_", "^") else f"<mi>{name}</mi>"
        if name in SPACES:
            return f"<mspace width='{SPACES[name]}'/>"
        if name in SIZES:
            return self.atom().replace(' stretchy="false"', "")
        if name in ("frac", "tfrac"):
            return f"<mfrac>{self.argument()}{self.argument()}</mfrac>"
        if name == "sqrt":
            return f"<msqrt>{self.argument()}</msqrt>"
        if name in ("mathrm", "text"):
            return f"<mtext>{escape(self._words())}</mtext>"
        if name in "{}|%":
            return f"<mo>{name}</mo>"
        raise ValueError(f"\\{name} is no command that the pages know")

    def _words(self) -> str:
        """Return the letters of a group."""
        words = ""
        token = self.next()
        if token != "{":
            return token
        while (token := self.next()) != "}":
            words += token
        return words


def _has_limits(atom: str) -> bool:
    return any(f">{sign}<" in atom for sign in UNDER) and atom.count("<m") == 1
