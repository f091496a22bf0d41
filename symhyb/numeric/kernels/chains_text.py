"""The C text of a program along chains of steps, eight side by side.

A compiler's time grows faster than the length of a function, so that the instructions of a step are
shared out among functions of :data:`TOGETHER`. What one of them leaves for another is in ``s``,
eight lanes each; what stays the same for all steps is computed once and in ``c``.
Sizes: C chains, S steps.
"""

from collections.abc import Iterable, Sequence

from symhyb.numeric.kernels.chains_source import LANES, PLAIN
from symhyb.numeric.kernels.expressions import HYPERBOLIC_TANGENT, expression, number
from symhyb.numeric.kernels.instructions import NOTHING, Program

TOGETHER = 500  # instructions; from 300 to 1000 the code and the compiler are as fast

Step = tuple[int, int, int, int]  # value, operation, left, right

_TEXT = """
#include <math.h>
{tangent}
enum {{ eight = {lanes} }};
typedef double vec __attribute__((vector_size(eight * sizeof(double)), may_alias));
#define EACH for (int l = 0; l < eight; l++)
#define APART static __attribute__((noinline)) void
const long long still = {still}, lanes = {slots};
/* rows of (place in s, array, entry); entries of the arrays */
static const int loads[][3] = {{{loads}}}, stores[][3] = {{{stores}}};
static const int width[] = {{{width}}}, made[] = {{{made}}};
{functions}
/* Arrays are (C, S, width), the start, which is array 0, (C, width); from then on the first result
   is fed back. p stays; c and s are room. Lanes that are left over do what the last chain does. */
void run(long long first, long long last, long long steps, const double *p, double *c, vec *s,
         const double *const *in, double *const *out) {{
  {fixed}
  {before}
  for (long long begin = first; begin < last; begin += eight) {{
    const int real = last - begin < eight ? (int)(last - begin) : eight;
    for (long long k = 0; k < steps; k++) {{
      for (int i = 0; i < {n_loads}; i++) {{
        const int which = loads[i][1];
        const long long wide = width[which], apart = which || k ? steps * wide : wide;
        const double *from = which ? in[which] + k * wide : k ? out[0] + (k - 1) * wide : in[0];
        double *to = (double *)(s + loads[i][0]);
        from += begin * apart + loads[i][2];
        EACH to[l] = from[(l < real ? l : real - 1) * apart];
      }}
      {inside}
      for (int i = 0; i < {n_stores}; i++) {{
        const long long wide = made[stores[i][1]];
        double *to = out[stores[i][1]] + (begin * steps + k) * wide + stores[i][2];
        const double *from = (const double *)(s + stores[i][0]);
        for (int l = 0; l < real; l++) to[l * steps * wide] = from[l];
      }}
    }}
  }}
}}
"""


def source(code: Program) -> str:
    """The C text of a function (x, …, p) → (x, …) along chains: ``run``, and how much room it
    needs, ``still`` numbers and ``lanes`` times eight."""
    last = len(code.arguments) - 1
    same = code.invariant(frozenset({last}))
    before = _shared_out([step for step in code.steps if same[step[0]]])
    inside = _shared_out([step for step in code.steps if not same[step[0]]])
    names = {value: f"({number(x)})" for value, x in code.constants}
    fixed = [(value, entry) for value, which, entry in code.loads if which == last]
    still = [*(value for value, _ in fixed), *(step[0] for part in before for step in part)]
    names |= {value: f"c[{i}]" for i, value in enumerate(still)}
    spread = [value for _, _, value in code.stores if same[value]]
    passed = [*(value for value, which, _ in code.loads if which != last), *spread]
    passed += _passed(code, inside)
    slots = {value: i for i, value in enumerate(dict.fromkeys(passed))}
    functions = [_still(i, part, names) for i, part in enumerate(before)]
    functions += [_moving(i, part, names, slots) for i, part in enumerate(inside)]
    loads = [(slots[v], which, entry) for v, which, entry in code.loads if which != last]
    stores = [(slots[value], output, entry) for output, entry, value in code.stores]
    everywhere = [f"EACH s[{slots[v]}][l] = {names[v]};" for v in dict.fromkeys(spread)]
    return _TEXT.format(
        tangent=HYPERBOLIC_TANGENT,
        lanes=LANES,
        still=len(still),
        slots=len(slots),
        loads=_table(loads),
        stores=_table(stores),
        width=", ".join(map(str, code.arguments)),
        made=", ".join(map(str, code.results)),
        functions="\n".join(functions),
        fixed=" ".join(f"{names[value]} = p[{entry}];" for value, entry in fixed),
        before=" ".join([*(f"before{i}(c);" for i in range(len(before))), *everywhere]),
        n_loads=len(loads),
        inside=" ".join(f"inside{i}(c, s);" for i in range(len(inside))),
        n_stores=len(stores),
    )


def _shared_out(steps: Sequence[Step]) -> list[Sequence[Step]]:
    return [steps[i : i + TOGETHER] for i in range(0, len(steps), TOGETHER)]


def _passed(code: Program, parts: Iterable[Sequence[Step]]) -> list[int]:
    """The values of one function that another asks for, or that are results."""
    home = {step[0]: i for i, part in enumerate(parts) for step in part}
    asked = [
        operand
        for step in code.steps
        for operand in step[2:]
        if operand in home and home[operand] != home[step[0]]
    ]
    return [*asked, *(value for _, _, value in code.stores if value in home)]


def _still(index: int, part: Sequence[Step], names: dict[int, str]) -> str:
    """A function for what is the same in all steps."""
    lines = list[str]()
    for value, operation, *operands in part:
        made = expression(operation, *(names[one] for one in operands if one != NOTHING))
        lines.append(f"{names[value]} = {made};")
    return "\n".join((f"APART before{index}(double *restrict c) {{", *lines, "}"))


def _moving(index: int, part: Sequence[Step], names: dict[int, str], slots: dict[int, int]) -> str:
    """A function for instructions of a step: those of ``names`` stay, those with ``slots`` come
    from other functions, or go to them."""
    lines, here = list[str](), set[int]()
    for value, operation, *operands in part:
        given = [one for one in operands if one != NOTHING]
        for one in given:
            if one not in here and one not in names:
                lines.append(f"const vec v{one} = s[{slots[one]}];")
                here.add(one)
        if operation in PLAIN:
            made = expression(operation, *(names.get(one, f"v{one}") for one in given))
            lines.append(f"const vec v{value} = {made};")
        else:
            made = expression(operation, *(names.get(one, f"v{one}[l]") for one in given))
            lines.append(f"vec v{value}; EACH v{value}[l] = {made};")
        if value in slots:
            lines.append(f"s[{slots[value]}] = v{value};")
        here.add(value)
    begin = f"APART inside{index}(const double *restrict c, vec *restrict s) {{"
    return "\n".join((begin, *lines, "}"))


def _table(rows: Sequence[tuple[int, int, int]]) -> str:
    """Rows as the values of a C array, which must have one."""
    return ", ".join(f"{{{a}, {b}, {c}}}" for a, b, c in rows) or "{0, 0, 0}"
