"""Libraries of two configurations in one program that cannot load them, renamed as docs/export.md says."""

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from drawbar.codegen.compiler import find_compiler

GUIDE = Path(__file__).parents[2] / "docs" / "export.md"
CALLER = """
#include <string.h>
#include "drawbar.h"
static struct drawbar_state state;
int NAME_begin(void);
int NAME_begin(void)
{
    return strcmp(drawbar_version(), DRAWBAR_VERSION) ? -1 : drawbar_init(&state);
}
"""
MAIN = """
int first_begin(void);
int second_begin(void);
int main(void) { return first_begin() != 0 || second_begin() != 0; }
"""


def test_two_configurations_are_linked_together(exported: Callable[..., Path], tmp_path: Path) -> None:
    for tool in ("objcopy", "nm", "ar"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    (recipe,) = re.findall(r"^    (nm -g .*?)\n\n", GUIDE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    compiler = [*find_compiler(), "-std=c99", "-O0"]
    for name, configuration in (("first", "articulated"), ("second", "lqr-pi")):
        folder, library = tmp_path / name, exported(configuration)
        folder.mkdir()
        (folder / "caller.c").write_text(CALLER.replace("NAME", name), "utf-8")
        for source in (folder / "caller.c", *library.glob("src/*.c")):  # of several zig makes one object
            subprocess.run([*compiler, f"-I{library / 'include'}", "-c", str(source)], cwd=folder, check=True)
        parts = [file.name for file in folder.glob("*.o") if file.stem != "caller"]
        subprocess.run(["ar", "rcs", "libdrawbar.a", *parts], cwd=folder, check=True)
        script = recipe.replace("garden_", f"{name}_")
        subprocess.run(["sh", "-e", "-c", script], cwd=folder, check=True)
    (tmp_path / "main.c").write_text(MAIN, "utf-8")
    parts = [f"{name}/{part}" for part in ("caller.o", "libdrawbar.a") for name in ("first", "second")]
    subprocess.run([*compiler, "main.c", *parts, "-lm", "-o", "program"], cwd=tmp_path, check=True)
    assert subprocess.run([str(tmp_path / "program")], check=False).returncode == 0
