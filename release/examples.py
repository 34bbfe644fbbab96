"""Runs the examples of a Markdown file in an empty folder, with the command that is in the path.

Blocks `palmistry file=NAME` are written as files; of blocks `console` each line behind `$` is run, and the lines below it must be what is printed:
`...` stands for any lines, and at the end of a line for the rest of it.
"""

import re
import subprocess
import sys

TIME = re.compile(r"\d+\.\d+ s$")


def agrees(shown: list[str], printed: list[str]) -> bool:
    """Whether what was printed is what is shown."""
    if not shown:
        return not printed
    if shown[0].strip() == "...":
        return any(agrees(shown[1:], printed[at:]) for at in range(len(printed) + 1))
    if not printed:
        return False
    first = printed[0]
    line = shown[0]
    same = first.startswith(line[: -len(" ...")]) if line.endswith(" ...") else TIME.sub("s", first) == TIME.sub("s", line)
    return same and agrees(shown[1:], printed[1:])


def main(path: str) -> None:
    """Runs all examples, and ends with a message at the first that is not as it is shown."""
    blocks = re.findall(r"^```(\S+)([^\n]*)\n(.*?)^```", open(path, encoding="utf-8").read(), re.M | re.S)
    count, status, left_out = 0, 0, []
    for kind, words, text in blocks:
        named = re.search(r"file=(\S+)", words)
        if kind == "palmistry" and named:
            with open(named[1], "w", encoding="utf-8") as file:
                file.write(text)
        if kind != "console":
            continue
        parts = re.split(r"^\$ ", text, flags=re.M)[1:]
        for part in parts:
            command, *shown = part.rstrip("\n").split("\n")
            if " proofs/" in command:
                # a file of the source tree, which is not here
                left_out.append(command)
                continue
            if command == "echo $?":
                printed = [str(status)]
            else:
                run = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
                status, printed = run.returncode, (run.stderr + run.stdout).rstrip("\n").split("\n")
                printed = [] if printed == [""] else printed
            if not agrees(shown, printed):
                sys.exit(f"not as shown: {command}\n" + "\n".join(printed))
            count += 1
    print(f"{count} commands answer as shown" + "".join(f"\nnot run, since it needs the source tree: {line}" for line in left_out))


main(sys.argv[1])
