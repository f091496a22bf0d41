"""C source of a Simulink S-function (level 2, C MEX) around the export. Experimental.

Never compiled against Simulink by us. The interface is that of the published manual, "Write Level-2
C MEX S-Functions"; its headers are the user's own and not part of what is written. An FMU is the
surer way; a block from source also goes where FMUs do not, into generated code among them.
"""

from symhyb.export.c_code import c_files, comment, filled
from symhyb.export.spec import Role, Spec


def simulink_files(spec: Spec) -> dict[str, str]:
    """The plain C of the export and NAME_sfun.c, which calls it."""
    name, exported = spec.identifier, spec.exported
    sign = "" if spec.whole else "   The outputs dF act: sum them to the forces of your plant. "
    values = {
        "PORTS": "\n\n".join(_listed(spec, role) for role in ("input", "output", "parameter")),
        "SIGN": sign,
        "NAME": name,
        "INPUTS": str(len(exported.inputs)),
        "OUTPUTS": str(len(exported.outputs)),
        "STATES": str(len(exported.states)),
        "PARAMETERS": str(len(exported.parameters)),
    }
    return {**c_files(spec), f"{name}_sfun.c": filled("simulink.c", values)}


def _listed(spec: Spec, role: Role) -> str:
    """Names and units of all variables of a role, numbered as MATLAB does."""
    rows = [
        f"          {i}: {v.name} [{v.unit.text}] {comment(v.about)}".rstrip()
        for i, v in enumerate(spec.of_role(role), 1)
    ]
    return "\n".join((f"        {role}s", *(rows or ["          none"])))
