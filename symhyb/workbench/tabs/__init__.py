"""The tabs of the workbench: each a part of the page with what fills it."""
