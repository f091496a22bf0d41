"""Numbers: SymPy lowered to CasADi once, integration by CVODES, windows with sensitivities."""
