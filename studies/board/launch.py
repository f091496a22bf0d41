"""Start a command under limits, where folders that are sealed cannot be read, and become it.

    python -I -S launch.py LIMITS COMMAND…

LIMITS is a JSON object: ``memory`` and ``file`` in bytes, ``seconds`` of the processor, ``hide``
(folders) and ``fd``, to which one byte is written: ``1`` if an empty file system lies over every
hidden folder, ``0`` where the system does not allow that. Standard library alone: it starts fast.
"""

import ctypes
import json
import os
import sys

NEW_NAMESPACES = 0x00020000, 0x10000000  # CLONE_NEWNS, CLONE_NEWUSER of sched.h
PRIVATE_RECURSIVE = 0x40000 | 0x4000  # MS_PRIVATE and MS_REC of mount.h


def limit(memory: int, file: int, seconds: int) -> None:
    """Limit memory, the size of a file, processor seconds and core dumps, where that is known."""
    try:
        import resource
    except ImportError:  # Windows: the clock alone limits
        return
    for what, most in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_FSIZE, file),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(what)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        try:
            resource.setrlimit(what, (most, most))
        except (OSError, ValueError):  # macOS knows no limit of the address space
            continue


def hide(folders: list[str]) -> bool:
    """Lay an empty file system over folders, for this process and its children alone."""
    if not sys.platform.startswith("linux"):
        return False
    libc = ctypes.CDLL(None)
    mounts, users = NEW_NAMESPACES
    uid, gid = os.getuid(), os.getgid()
    if libc.unshare(mounts) != 0:
        if libc.unshare(mounts | users) != 0:
            return False
        try:
            for name, text in (
                ("setgroups", "deny"),
                ("uid_map", f"{uid} {uid} 1"),
                ("gid_map", f"{gid} {gid} 1"),
            ):
                with open(f"/proc/self/{name}", "w") as file:
                    file.write(text)
        except OSError:
            return False
    if libc.mount(b"none", b"/", None, PRIVATE_RECURSIVE, None) != 0:
        return False
    return all(
        libc.mount(b"tmpfs", folder.encode(), b"tmpfs", 0, b"size=64k") == 0 for folder in folders
    )


def main() -> None:
    """Limit, hide, and become the command."""
    wanted = json.loads(sys.argv[1])
    hidden = hide(wanted["hide"])
    os.write(wanted["fd"], b"1" if hidden else b"0")
    os.close(wanted["fd"])
    limit(wanted["memory"], wanted["file"], wanted["seconds"])
    try:
        os.execvp(sys.argv[2], sys.argv[2:])
    except OSError as error:
        sys.exit(f"{sys.argv[2]}: {error.strerror}")


if __name__ == "__main__":
    main()
