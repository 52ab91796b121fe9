#!/usr/bin/env bash
# Cairo's SVG of one drawing differs by what the process drew before
#
# One would swear: the same drawing, written twice by one program, is the same
#   SVG file byte for byte; what changes a vector file is a date, and SVG has none.
# What happens: the outermost group is named by a counter of surfaces that runs
#   through the whole process, and it counts surfaces that are
#   neither SVG nor written: <g id="surface1"> becomes <g id="surface6">, and an
#   image surface made between them moves it again. All else is the same, and so
#   is the first file of every new process.
# What follows: a figure compared by its bytes (a golden file, a cache's key, a
#   repository of results) is stable when a test runs alone and differs in a
#   suite, or when another plot was exported first. Rename the group, or compare
#   what is drawn. (PDF has its own date, which can be set; PNG is the same.)
set -u
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
have() { dpkg-query -W -f '${Version}' "$1" 2>/dev/null; }
want() { # package, start of its version
  [ -n "$(have "$1")" ] || { apt-get update -qq && apt-get install -y -qq --no-install-recommends \
    -o DPkg::Lock::Timeout=300 "$1"; } >"$tmp/apt.log" 2>&1
  case $(have "$1") in
    "$2"*) echo "version: $1 $(have "$1")" ;;
    *) echo "$1 '$(have "$1")', wanted $2: not looked at"; exit 2 ;;
  esac
}
want python3-cairo 1.20.1
want libcairo2 1.16.0
echo "expected: one drawing, written three times, is one file"
cat >"$tmp/t.py" <<'PY'
import io
import re
import sys
import cairo


def svg():
    file = io.BytesIO()
    with cairo.SVGSurface(file, 200, 100) as surface:
        context = cairo.Context(surface)
        context.move_to(10, 10)
        context.line_to(190, 90)
        context.stroke()
    return file.getvalue().decode()


def png():
    file = io.BytesIO()
    surface = cairo.ImageSurface(cairo.FORMAT_RGB24, 200, 100)
    context = cairo.Context(surface)
    context.move_to(10, 10)
    context.line_to(190, 90)
    context.stroke()
    surface.write_to_png(file)
    return file.getvalue()


if sys.argv[1:] == ["first"]:
    print(svg())
    sys.exit()
name = re.compile(r'id="surface(\d+)"')
first, second = svg(), svg()
pictures = [png(), png()]
third = svg()
ids = [name.search(text).group(1) for text in (first, second, third)]
print("names of the outermost group:", ", ".join(ids))
alike = len({name.sub("", text) for text in (first, second, third)}) == 1
print("all else the same:", alike, "| PNG the same:", pictures[0] == pictures[1])
sys.exit(0 if len(set(ids)) == 3 and alike and pictures[0] == pictures[1] else 1)
PY
/usr/bin/python3 "$tmp/t.py"
status=$?
/usr/bin/python3 "$tmp/t.py" first >"$tmp/a" && /usr/bin/python3 "$tmp/t.py" first >"$tmp/b"
if cmp -s "$tmp/a" "$tmp/b"; then echo "the first of two processes: the same"; else status=1; fi
[ $status = 0 ] && echo "seen: the same drawing has another name each time within a process" ||
  echo "CHANGED: this is no longer what happens"
exit $status
