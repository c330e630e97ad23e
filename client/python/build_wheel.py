"""build_wheel.py PACKAGE FOLDER: builds the wheel of a package with what is installed. Prints what went wrong alone."""

import subprocess
import sys

package, folder = sys.argv[1:]
command = [sys.executable, "-m", "build", "--no-isolation", "--wheel", "--outdir", folder, package]
built = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
if built.returncode != 0:
    print(built.stdout, file=sys.stderr)
sys.exit(built.returncode)
