"""Writes expressions as C++: what depends on parameters alone is worked out once per run."""

from collections.abc import Sequence

from gear_damping.simulation.native.expressions import TEMPLATES, Expression, Program, Value

# A stage's function is called, not repeated at each of its twenty places: that compiles four times faster and runs
# as fast within 5 % (benchmarks/ times it).
CALLED = "__attribute__((noinline)) static"


class Written:
    """A program as C++: the values of a run (`setup`) and functions of a stage."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.kept: dict[Value, int] = {}  # values of a run that stages read, and where they are kept

    def function(self, name: str, results: Sequence[Expression]) -> str:
        """A function that writes `results` to `out`, reading the kept values of a run from `Q`."""
        lines = [f"  const {_type(v)} {_name(v)} = {self._text(v)};" for v in self._needed(results, stage=True)]
        lines += [f"  out[{i}] = vd{{}} + {self._read(result)};" for i, result in enumerate(results)]
        arguments = "vd u, const vd* y, const vd* P, const vd* S, double index, const vd* L, const vd* Q, vd* out"
        return "\n".join([f"{CALLED} void {name}({arguments}) {{", *lines, "}"])

    def operations(self, results: Sequence[Expression]) -> int:
        """Operations of a function that writes these."""
        return len(self._needed(results, stage=True))

    def setup(self) -> str:
        """The function that fills `Q`; call it after every `function` was written."""
        needed = self._needed(list(self.kept), stage=False)
        lines = [f"  const {_type(v)} {_name(v)} = {self._text(v)};" for v in needed]
        lines += [f"  Q[{place}] = vd{{}} + {_name(value)};" for value, place in self.kept.items()]
        return "\n".join(["static inline void setup(const vd* P, vd* Q) {", *lines, "}"])

    def _needed(self, results: Sequence[Expression], stage: bool) -> list[Value]:
        """Values to work out, in order; in a stage those of a run are read instead."""
        wanted: set[Value] = set()
        queue = [r for r in results if isinstance(r, Value)]
        while queue:
            value = queue.pop()
            if value in wanted or value not in self.program.made:
                continue
            if stage and not value.varies and value.kind == "number":
                self.kept.setdefault(value, len(self.kept))
                continue
            wanted.add(value)
            queue += [a for a in self.program.made[value][1] if isinstance(a, Value)]
        return [value for value in self.program.made if value in wanted]

    def _text(self, value: Value) -> str:
        name, arguments = self.program.made[value]
        texts = [self._read(a, value.varies) for a in arguments]
        if name == "where":
            texts[1:] = [f"(vd{{}} + {text})" for text in texts[1:]]
        elif name not in ("add", "sub", "mul", "div") or all(not isinstance(a, Value) for a in arguments):
            texts = [t if isinstance(a, Value) else f"(vd{{}} + {t})" for a, t in zip(arguments, texts, strict=True)]
        return TEMPLATES[name].format(*texts)

    def _read(self, a: Expression, stage: bool = True) -> str:
        if not isinstance(a, Value):
            return repr(float(a)) if a == a and abs(a) != float("inf") else _special(a)
        if a in self.program.inputs:
            return self.program.inputs[a]
        if stage and a in self.kept:
            return f"Q[{self.kept[a]}]"
        return _name(a)


def _special(number: float) -> str:
    return '__builtin_nan("")' if number != number else ("" if number > 0 else "-") + "__builtin_inf()"


def _name(value: Value) -> str:
    return f"t{value.index}"


def _type(value: Value) -> str:
    return "vm" if value.kind == "mask" else "vd"
