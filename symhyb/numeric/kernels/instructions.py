"""The straight-line code of a CasADi SX function, in single-assignment form.

Shared by what turns a function into other code (:mod:`chains`,
:mod:`~symhyb.numeric.runs.explicit`) and by what keeps it on disk (:mod:`cache`). Every value has a
number and is computed exactly once:

    loads       value <- entry of an argument
    constants   value <- number
    steps       value <- operation(left, right)
    stores      entry of an output <- value
"""

from dataclasses import dataclass, replace

import casadi as ca

NOTHING = -1  # in place of the right operand of an operation with one operand

UNARY = frozenset(
    (
        ca.OP_NEG,
        ca.OP_EXP,
        ca.OP_LOG,
        ca.OP_SQRT,
        ca.OP_SQ,
        ca.OP_TWICE,
        ca.OP_SIN,
        ca.OP_COS,
        ca.OP_TAN,
        ca.OP_ASIN,
        ca.OP_ACOS,
        ca.OP_ATAN,
        ca.OP_NOT,
        ca.OP_FLOOR,
        ca.OP_CEIL,
        ca.OP_FABS,
        ca.OP_SIGN,
        ca.OP_ERF,
        ca.OP_ERFINV,
        ca.OP_INV,
        ca.OP_SINH,
        ca.OP_COSH,
        ca.OP_TANH,
        ca.OP_ASINH,
        ca.OP_ACOSH,
        ca.OP_ATANH,
        ca.OP_LOG1P,
        ca.OP_EXPM1,
    )
)
BINARY = frozenset(
    (
        ca.OP_ADD,
        ca.OP_SUB,
        ca.OP_MUL,
        ca.OP_DIV,
        ca.OP_POW,
        ca.OP_CONSTPOW,
        ca.OP_LT,
        ca.OP_LE,
        ca.OP_EQ,
        ca.OP_NE,
        ca.OP_AND,
        ca.OP_OR,
        ca.OP_FMOD,
        ca.OP_COPYSIGN,
        ca.OP_IF_ELSE_ZERO,
        ca.OP_FMIN,
        ca.OP_FMAX,
        ca.OP_ATAN2,
        ca.OP_HYPOT,
        ca.OP_REMAINDER,
    )
)


@dataclass(frozen=True, slots=True)
class Program:
    """What an SX function does. Entries count along the columns of the dense matrix.

    Attributes:
        loads: (value, argument, entry), sorted by the latter; each entry at most once.
        constants: (value, number).
        steps: (value, operation, left, right) in order; ``right`` may be ``NOTHING``.
        stores: (output, entry, value), sorted; entries that are not listed are zero.
        size: how many values there are.
        arguments: entries of each argument, those that are not used included.
        results: entries of each output.
    """

    loads: tuple[tuple[int, int, int], ...]
    constants: tuple[tuple[int, float], ...]
    steps: tuple[tuple[int, int, int, int], ...]
    stores: tuple[tuple[int, int, int], ...]
    size: int
    arguments: tuple[int, ...]
    results: tuple[int, ...]

    def full(self) -> frozenset[int]:
        """The outputs of which every entry is stored."""
        count = [0] * len(self.results)
        for output, _, _ in self.stores:
            count[output] += 1
        return frozenset(i for i, entries in enumerate(self.results) if count[i] == entries)

    def operations(self) -> frozenset[int]:
        """Every operation that occurs, as CasADi numbers them."""
        return frozenset(step[1] for step in self.steps)

    def invariant(self, repeated: frozenset[int]) -> tuple[bool, ...]:
        """Whether each value is the same for all samples when the arguments ``repeated`` are."""
        same = [False] * self.size
        for value, argument, _ in self.loads:
            same[value] = argument in repeated
        for value, _ in self.constants:
            same[value] = True
        for value, _, left, right in self.steps:
            same[value] = same[left] and (right == NOTHING or same[right])
        return tuple(same)

    def gathered(self, fixed: frozenset[int]) -> "Program":
        """The same with the arguments ``fixed`` one below the other in one, which is the last."""
        moving = [i for i in range(len(self.arguments)) if i not in fixed]
        place = {argument: (i, 0) for i, argument in enumerate(moving)}
        size = 0
        for argument in sorted(fixed):
            place[argument] = len(moving), size
            size += self.arguments[argument]
        loads = tuple((v, place[i][0], place[i][1] + entry) for v, i, entry in self.loads)
        return replace(self, loads=loads, arguments=(*(self.arguments[i] for i in moving), size))

    def divided_once(self, repeated: frozenset[int]) -> "Program":
        """The same with a factor in place of each divisor that stays when the arguments
        ``repeated`` do: its inverse is computed once, and a product is quicker than a quotient."""
        same, size = self.invariant(repeated), self.size
        inverse: dict[int, int] = {}
        steps = list[tuple[int, int, int, int]]()
        for value, operation, left, right in self.steps:
            if operation == ca.OP_DIV and same[right] and not same[left]:
                if right not in inverse:
                    inverse[right], size = size, size + 1
                    steps.append((inverse[right], ca.OP_INV, right, NOTHING))
                operation, right = ca.OP_MUL, inverse[right]
            steps.append((value, operation, left, right))
        return replace(self, steps=tuple(steps), size=size)


def program(function: ca.Function) -> Program | None:
    """Read the instructions of ``function``; None if it is not made of scalar operations alone."""
    if not function.is_a("SXFunction"):
        return None
    into = [function.sparsity_in(i).find() for i in range(function.n_in())]
    out = [function.sparsity_out(i).find() for i in range(function.n_out())]
    held: dict[int, int] = {}  # work slot of CasADi -> value
    loads: dict[tuple[int, int], int] = {}
    constants: list[tuple[int, float]] = []
    steps: list[tuple[int, int, int, int]] = []
    stores: list[tuple[int, int, int]] = []
    size = 0
    for i in range(function.n_instructions()):
        operation = function.instruction_id(i)
        given, taken = function.instruction_input(i), function.instruction_output(i)
        if operation == ca.OP_OUTPUT:
            stores.append((taken[0], out[taken[0]][taken[1]], held[given[0]]))
        elif operation == ca.OP_INPUT:
            entry = (given[0], into[given[0]][given[1]])
            if entry not in loads:
                loads[entry], size = size, size + 1
            held[taken[0]] = loads[entry]
        elif operation == ca.OP_ASSIGN:
            held[taken[0]] = held[given[0]]
        elif operation == ca.OP_CONST:
            constants.append((size, function.instruction_constant(i)))
            held[taken[0]], size = size, size + 1
        elif operation in UNARY or operation in BINARY:
            right = held[given[1]] if operation in BINARY else NOTHING
            steps.append((size, operation, held[given[0]], right))
            held[taken[0]], size = size, size + 1
        else:
            return None
    return Program(
        tuple((value, *entry) for entry, value in sorted(loads.items())),
        tuple(constants),
        tuple(steps),
        tuple(sorted(stores)),
        size,
        tuple(function.numel_in(i) for i in range(function.n_in())),
        tuple(function.numel_out(i) for i in range(function.n_out())),
    )
