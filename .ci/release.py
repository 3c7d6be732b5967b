#!/usr/bin/env python3
"""Builds what people get who have no Rust: an archive, and on Debian a package.

    .ci/release.py                              for this machine
    .ci/release.py --target TRIPLE              for another one
    .ci/release.py --zig 2.17 [--target TRIPLE] for Linux with this glibc or a newer one, by
                                                cargo-zigbuild
    .ci/release.py --deb                        a Debian package, too (needs dpkg-deb)
    .ci/release.py --wheel                      the Python package as a wheel, too (needs maturin)
    .ci/release.py --binary FILE                packs a binary, with the library for C beside it

The archives are in target/archives, with their checksums. They contain the program, manual pages
and completions, licences (those of the crates in it as well), programs to begin with, the library
for C, and the robot program for the cabinet. The same binary gives the same archive.
"""

import argparse
import gzip
import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "target/archives"
SHELLS = {"bash": "iiwasim.bash", "zsh": "_iiwasim", "fish": "iiwasim.fish"}
DEBIAN_ARCHITECTURES = {"x86_64": "amd64", "aarch64": "arm64"}
# The library for C that programs load; the second one of Windows is what they are linked with.
C_LIBRARIES = {
    "windows": ("iiwasim.dll", "iiwasim.dll.lib"),
    "apple": ("libiiwasim.dylib",),
    "linux": ("libiiwasim.so",),
}
# Texts that licences ask to be handed on.
LICENCE_FILES = ("license", "licence", "copying", "notice", "copyright", "unlicense")


def output(*command):
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def build(target, glibc):
    """The program, and the library for C beside it."""
    command = [
        "cargo",
        "zigbuild" if glibc else "build",
        "--release",
        "--locked",
        "--features",
        "iiwasim/full",
    ]
    command += [
        "-p",
        "iiwasim",
        "-p",
        "iiwa-c",
        "--target",
        f"{target}.{glibc}" if glibc else target,
    ]
    subprocess.run(command, cwd=ROOT, check=True)
    return (
        ROOT / "target" / target / "release" / ("iiwasim.exe" if "windows" in target else "iiwasim")
    )


def build_wheel(target, glibc):
    """The Python package; one wheel serves each version from 3.9 on."""
    with tempfile.TemporaryDirectory() as scratch:
        command = ["maturin", "build", "-q", "--release", "--locked", "-m", "python/Cargo.toml"]
        command += ["--target", target, "--out", scratch]
        if glibc:
            command += ["--zig", "--compatibility", f"manylinux_{glibc.replace('.', '_')}"]
        subprocess.run(command, cwd=ROOT, check=True)
        (wheel,) = Path(scratch).glob("*.whl")
        return Path(shutil.copy(wheel, DIST))


def crates(target):
    """Packages of others that the program has in it."""
    metadata = json.loads(
        output(
            "cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", target
        )
    )
    packages = {package["id"]: package for package in metadata["packages"]}
    # One line a package: metadata alone has no features of one program.
    tree = output(
        "cargo",
        "tree",
        "-p",
        "iiwasim",
        "--features",
        "full",
        "-e",
        "normal",
        "--target",
        target,
        "--prefix",
        "none",
        "-f",
        "{p}",
    )
    wanted = {tuple(line.split()[:2]) for line in tree.splitlines() if line.strip()}
    found = [
        p for p in packages.values() if (p["name"], f"v{p['version']}") in wanted and p["source"]
    ]
    return sorted(found, key=lambda package: (package["name"], package["version"]))


def third_party(target):
    """Who made these, and their licences' texts, each once."""
    texts, without = {}, []
    for package in crates(target):
        name = f"{package['name']} {package['version']} ({package['license'] or 'see its text'})"
        folder = Path(package["manifest_path"]).parent
        files = [
            f
            for f in sorted(folder.rglob("*"))
            if f.is_file() and f.name.lower().startswith(LICENCE_FILES)
        ]
        files = [
            f
            for f in files
            if f.suffix.lower() in ("", ".md", ".txt", ".mit", ".apache")
            or "license-" in f.name.lower()
        ]
        for file in files:
            text = file.read_text(encoding="utf-8", errors="replace").strip().replace("\r\n", "\n")
            texts.setdefault(text, []).append(name)
        if not files:
            without.append(name)
    lines = ["iiwasim contains these packages, under the licences below.", ""]
    for text, names in sorted(texts.items(), key=lambda entry: sorted(set(entry[1]))):
        lines += ["=" * 78, *sorted(set(names)), "=" * 78, "", text, ""]
    if without:
        lines += [
            "=" * 78,
            "Packages without a text of their own; their licences are among those above:",
            *without,
        ]
    return "\n".join(lines) + "\n"


def runs_here(target):
    return target == host()


def host():
    return next(
        line.split()[1] for line in output("rustc", "-vV").splitlines() if line.startswith("host:")
    )


def collect(folder, binary, target):
    """Everything that the archive has."""
    program = folder / binary.name
    shutil.copyfile(binary, program)
    program.chmod(0o755)
    if shutil.which("strip") and runs_here(target):
        subprocess.run(["strip", program], check=True)
    for name in ("README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"):
        shutil.copyfile(ROOT / name, folder / name)
    (folder / "THIRD-PARTY.txt").write_text(third_party(target), encoding="utf-8")
    collect_c(folder, binary.parent, target)
    # The robot's half, if it was built: `mvn -f sunrise/pom.xml package`.
    sunrise = ROOT / "sunrise/target/iiwasim-sunrise.zip"
    if sunrise.exists():
        shutil.copyfile(sunrise, folder / sunrise.name)
    else:
        print(f"{sunrise.name} is left out: it has not been built")
    fixtures = folder / "fixtures"
    fixtures.mkdir()
    for file in sorted((ROOT / "fixtures").glob("*.json")):
        shutil.copyfile(file, fixtures / file.name)
    if not runs_here(target):
        print("manual pages and completions are left out: the program does not run here")
        return
    completions = folder / "completions"
    completions.mkdir()
    for shell, name in SHELLS.items():
        text = subprocess.run(
            [program, "completions", shell], check=True, capture_output=True
        ).stdout
        (completions / name).write_bytes(text)
    subprocess.run([program, "man", folder / "man"], check=True, stdout=subprocess.DEVNULL)


def collect_c(folder, built, target):
    """The library for C with its header, where pkg-config looks for them."""
    names = next(names for system, names in C_LIBRARIES.items() if system in target)
    crate = ROOT / "crates/front/iiwa-c"
    files = {built / name: f"lib/{name}" for name in names}
    files |= {
        crate / "include/iiwasim.h": "include/iiwasim.h",
        crate / "iiwasim.pc": "lib/pkgconfig/iiwasim.pc",
    }
    for source, place in files.items():
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, folder / place)
    if shutil.which("strip") and runs_here(target) and "linux" in target:
        subprocess.run(["strip", "--strip-unneeded", folder / "lib/libiiwasim.so"], check=True)


def write_archive(folder, target, at_s):
    """A .zip for Windows, else a .tar.gz; entries sorted, without whose they were."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    if "windows" in target:
        archive = DIST / f"{folder.name}.zip"
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as out:
            for file in files:
                out.write(file, file.relative_to(folder.parent).as_posix())
        return archive
    archive = DIST / f"{folder.name}.tar.gz"
    plain = io.BytesIO()
    with tarfile.open(fileobj=plain, mode="w", format=tarfile.PAX_FORMAT) as out:
        for file in files:
            entry = out.gettarinfo(file, file.relative_to(folder.parent).as_posix())
            entry.uid = entry.gid = 0
            entry.uname = entry.gname = "root"
            entry.mtime = at_s
            entry.mode = 0o755 if os.access(file, os.X_OK) else 0o644
            with file.open("rb") as content:
                out.addfile(entry, content)
    archive.write_bytes(gzip.compress(plain.getvalue(), 9, mtime=at_s))
    return archive


def write_debian_package(folder, target, version, glibc):
    architecture = DEBIAN_ARCHITECTURES[target.split("-")[0]]
    with tempfile.TemporaryDirectory() as scratch:
        root = Path(scratch) / "root"
        places = {
            "iiwasim": "usr/bin/iiwasim",
            "README.md": "usr/share/doc/iiwasim/README.md",
            "CHANGELOG.md": "usr/share/doc/iiwasim/CHANGELOG.md",
            "LICENSE-MIT": "usr/share/doc/iiwasim/LICENSE-MIT",
            "LICENSE-APACHE": "usr/share/doc/iiwasim/LICENSE-APACHE",
            "THIRD-PARTY.txt": "usr/share/doc/iiwasim/copyright",
            "iiwasim-sunrise.zip": "usr/share/iiwasim/iiwasim-sunrise.zip",
            "completions/iiwasim.bash": "usr/share/bash-completion/completions/iiwasim",
            "completions/_iiwasim": "usr/share/zsh/vendor-completions/_iiwasim",
            "completions/iiwasim.fish": "usr/share/fish/vendor_completions.d/iiwasim.fish",
        }
        for file in sorted(folder.glob("man/*")):
            places[f"man/{file.name}"] = f"usr/share/man/man1/{file.name}.gz"
        for file in sorted(folder.glob("fixtures/*")):
            places[f"fixtures/{file.name}"] = f"usr/share/doc/iiwasim/fixtures/{file.name}"
        for source, place in places.items():
            if not (folder / source).exists():
                continue
            to = root / place
            to.parent.mkdir(parents=True, exist_ok=True)
            content = (folder / source).read_bytes()
            to.write_bytes(gzip.compress(content, 9, mtime=0) if place.endswith(".gz") else content)
            to.chmod(0o755 if place.startswith("usr/bin/") else 0o644)
        size_kb = sum(path.stat().st_size for path in root.rglob("*") if path.is_file()) // 1024
        control = root / "DEBIAN/control"
        control.parent.mkdir()
        control.write_text(
            f"Package: iiwasim\nVersion: {version}\nArchitecture: {architecture}\n"
            "Maintainer: The iiwasim developers <iiwasim@localhost>\n"
            f"Depends: libc6 (>= {glibc}), libgcc-s1\nSection: science\nPriority: "
            f"optional\nInstalled-Size: {size_kb}\n"
            "Description: motion simulator for the KUKA LBR iiwa\n"
            " Plans motion programs, runs them on the robot or a simulated one, and holds what "
            "was\n"
            " measured against the plan.\n"
        )
        package = DIST / f"iiwasim_{version}_{architecture}.deb"
        subprocess.run(
            ["dpkg-deb", "--build", "--root-owner-group", root, package],
            check=True,
            stdout=subprocess.DEVNULL,
        )
    return package


def needed_glibc(binary):
    """The newest version of the symbols that it asks for."""
    content = binary.read_bytes()
    versions, at = [], content.find(b"GLIBC_2.")
    while at >= 0:
        text = content[at + 6 : content.find(b"\0", at)].decode("ascii", errors="replace")
        if all(part.isdigit() for part in text.split(".")):
            versions.append(tuple(int(part) for part in text.split(".")))
        at = content.find(b"GLIBC_2.", at + 1)
    return ".".join(str(part) for part in max(versions))


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--target", help="triple of the machine that it is for")
    parser.add_argument(
        "--zig", metavar="GLIBC", help="with cargo-zigbuild, for this version of glibc"
    )
    parser.add_argument("--deb", action="store_true", help="a Debian package, too")
    parser.add_argument("--wheel", action="store_true", help="the Python package as a wheel, too")
    parser.add_argument("--binary", type=Path, help="pack this one")
    options = parser.parse_args()
    target = options.target or host()
    binary = options.binary or build(target, options.zig)
    version = json.loads(
        output("cargo", "metadata", "--format-version", "1", "--no-deps", "--locked")
    )
    version = next(
        package["version"] for package in version["packages"] if package["name"] == "iiwasim"
    )
    at_s = int(output("git", "log", "-1", "--format=%ct").strip())
    DIST.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / f"iiwasim-{version}-{target}"
        folder.mkdir()
        collect(folder, binary, target)
        made = [write_archive(folder, target, at_s)]
        if options.deb:
            made.append(
                write_debian_package(folder, target, version, needed_glibc(folder / "iiwasim"))
            )
    if options.wheel:
        made.append(build_wheel(target, options.zig))
    for file in made:
        digest = hashlib.sha256(file.read_bytes()).hexdigest()
        (DIST / f"{file.name}.sha256").write_text(f"{digest}  {file.name}\n")
        print(f"{file.relative_to(ROOT)}  {file.stat().st_size / 1e6:.1f} MB  {digest}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
