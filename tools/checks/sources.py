"""What the checks share: the project's files, and C++ text without comments."""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

TOKEN = re.compile(r"""
    (?P<include>^[ \t]*\#[ \t]*include[^\n]*)
    |(?P<comment>//[^\n]*|/\*.*?\*/)
    |(?P<literal>R"(?P<delimiter>\w*)\(.*?\)(?P=delimiter)"|"(?:\\.|[^"\\\n])*"|(?<!\w)'(?:\\.|[^'\\\n])+')
    """, re.DOTALL | re.MULTILINE | re.VERBOSE)


def project_files(root, suffixes, folder="."):
    """Files that git tracks or would track; outside of a git checkout every file but those under build and out."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard", folder],
                            capture_output=True, text=True)
    if listed.returncode == 0:
        files = [root / line for line in listed.stdout.splitlines()]
    else:
        files = [file for file in (root / folder).rglob("*")
                 if file.relative_to(root).parts[0] not in ("build", "out", ".git")]
    return sorted(file for file in set(files) if file.suffix in suffixes and file.is_file())


def without_comments(text):
    """The same lines, with comments and the contents of string literals blanked out; #include lines stay whole."""
    def blank(match):
        found = match.group()
        if match.lastgroup == "include":
            return re.sub(r"//.*", "", found)
        return ('""' if match.lastgroup == "literal" else "") + "\n" * found.count("\n")

    return TOKEN.sub(blank, text)


def report(name, findings, advice):
    """Prints the findings and ends the program: exit code 1 if there are any."""
    for finding in findings:
        print(finding)
    print(f"{name}: {len(findings)} finding(s)" + (f". {advice}" if findings else ""))
    sys.exit(1 if findings else 0)
