"""The header in C11 and C++17, the example in CMake, and programs in C under valgrind."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

CRATE = Path(__file__).resolve().parents[1]
STRICT = ["-Wall", "-Wextra", "-pedantic", "-Werror"]

# A program with an unreachable target, and the place of that error.
BAD = """{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": [
  { "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0] },
  { "type": "ptp", "joints_deg": [10, 0, 0, 130, 0, 0, 0] }
] }"""
BAD_AT = (3, 45)


def run(*command, code=0, **options):
    done = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, check=False, **options
    )
    if done.returncode != code:
        raise SystemExit(
            f"{' '.join(map(str, command))}: exit code {done.returncode}, expected "
            f"{code}\n{done.stdout}{done.stderr}"
        )
    return done


def install(library, prefix):
    """Installs header, libraries and pkg-config file as in the guide."""
    for folder in ("include", "lib/pkgconfig"):
        (prefix / folder).mkdir(parents=True)
    shutil.copy(CRATE / "include/iiwasim.h", prefix / "include")
    shutil.copy(library, prefix / "lib")
    shutil.copy(CRATE / "iiwasim.pc", prefix / "lib/pkgconfig")


def check(library, program, loaded, folder):
    """Compiles and runs all programs; `loaded` is the same library, with the expected figures."""
    header = CRATE / "include/iiwasim.h"
    for compiler, language, standard in [("gcc", "c", "c11"), ("g++", "c++", "c++17")]:
        run(compiler, f"-std={standard}", *STRICT, "-fsyntax-only", "-x", language, header)
    print("the header compiles as C11 and as C++17, without a warning")

    prefix = folder / "prefix"
    install(library, prefix)
    environment = os.environ | {"PKG_CONFIG_PATH": str(prefix / "lib/pkgconfig")}
    version = run("pkg-config", "--modversion", "iiwasim", env=environment).stdout.strip()
    own = loaded.c.iiwasim_version().decode()
    assert version == own, f"iiwasim.pc is of version {version}, the library of version {own}"
    flags = f"-DCMAKE_C_FLAGS={' '.join(STRICT)}", f"-DCMAKE_CXX_FLAGS={' '.join(STRICT)}"
    build = folder / "build"
    run("cmake", "-S", CRATE / "examples/cmake", "-B", build, *flags, env=environment)
    run("cmake", "--build", build, env=environment)
    with loaded.plan(program) as plan:
        cycle_time_s = loaded.figures(plan)["cycle_time_s"]
        at_1_s = loaded.at(plan, 1.0)
        end = loaded.at(plan, cycle_time_s)
    printed = run(build / "plan_c", program).stdout.splitlines()
    assert printed[0] == f"iiwasim {own}: {cycle_time_s:.3f} s", printed[0]
    line = (
        f"  1.000 s  motion {at_1_s.motion}  A4 {at_1_s.q[3]:8.5f} rad {at_1_s.dq[3]:8.5f} rad/s  "
        "TCP "
    )
    assert printed[2].startswith(line), printed[2]
    cpp = run(build / "plan_cpp", program).stdout
    assert cpp == f"{cycle_time_s:.3f} s, then A4 is at {end.q[3]:.5f} rad\n", cpp
    print(f"CMake finds the library; C and C++ print {cycle_time_s:.3f} s")

    archive = library.with_suffix(".a")
    if archive.is_file():
        source = CRATE / "examples/cmake/plan.c"
        private = re.search(
            r"^Libs.private: (.*)$", (CRATE / "iiwasim.pc").read_text(), re.MULTILINE
        )[1].split()
        static = folder / "plan_static"
        run(
            "gcc",
            "-std=c11",
            *STRICT,
            f"-I{header.parent}",
            source,
            archive,
            *private,
            "-o",
            static,
        )
        assert run(static, program).stdout.splitlines() == printed
        print("linked with the archive, it prints the same")

    check_memory(build / "plan_c", program, folder)
    check_fmu_memory(library, program, loaded, folder)


VALGRIND = (
    "valgrind",
    "--error-exitcode=99",
    "--leak-check=full",
    "--show-leak-kinds=definite,indirect,possible",
)


def check_memory(plan_c, program, folder):
    bad = folder / "bad.json"
    bad.write_text(BAD)
    for file, code in [(program, 0), (bad, 1), (folder / "none.json", 1)]:
        done = run(*VALGRIND, plan_c, file, "100", code=code)
        assert "ERROR SUMMARY: 0 errors" in done.stderr, done.stderr
        if file == bad:
            line, column = BAD_AT
            assert f"{bad}:{line}:{column}: motion 2: joint A4 is at 130 deg" in done.stderr, (
                done.stderr
            )
    print("valgrind: no error and no leak, of a plan, a refused program and a missing file")


def check_fmu_memory(library, program, loaded, folder):
    """Calls the FMI functions from a C program under valgrind."""
    with loaded.plan(program) as plan:
        files = json.loads(loaded.text("iiwasim_plan_fmu_json", plan, b"arm"))
        planned = [loaded.at(plan, t_s).q[3] for t_s in (0.8, 0.4)]
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    token = re.search('instantiationToken="([^"]*)"', files["modelDescription.xml"])[1]
    fmu, source = folder / "fmu", CRATE / "tests/fmu.c"
    run("gcc", "-std=c11", *STRICT, source, f"-L{library.parent}", "-liiwasim", "-o", fmu)
    environment = os.environ | {"LD_LIBRARY_PATH": str(library.parent)}
    done = run(*VALGRIND, fmu, token, folder / "resources", 80, env=environment)
    assert "ERROR SUMMARY: 0 errors" in done.stderr, done.stderr
    one, other, again = map(float, done.stdout.split())
    assert abs(one - planned[0]) <= 1e-12 and abs(other - planned[1]) <= 1e-12 and again == other, (
        done.stdout
    )
    print("valgrind: no error and no leak, of two instances of an FMU")
