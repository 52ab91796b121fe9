#!/usr/bin/env bash
# tiff and UTIF read tiled depth rightly only where it is not compressed: differences cross the tiles
#
# One would swear: a 16-bit TIFF in tiles, LZW or Deflate with horizontal differences, as ImageMagick
#   and libvips write it unasked as soon as tiles and compression are named, comes out as it went in,
#   or is refused; tiles without compression do, so do compressed strips.
# What happens: each tile holds differences of its own; tiff puts the tiles together first and then
#   adds up along the whole row, so that each tile begins on top of the last value of the one before;
#   the first column of tiles alone is right. UTIF adds up over as many pixels as the picture is wide,
#   also within a tile: of each tile's rows here one in four is right. A wall at 2000 to 2063 mm comes
#   out of tiff as a staircase of 2, 4, 6 and 8 m. Neither says anything; both are right with tiles and
#   no predictor, and with strips and one.
# What follows: ask for tag 317 (Predictor) and 322 (TileWidth) together before one of them reads a
#   picture; write depth in strips. A depth that doubles at regular columns has this.
set -u
tiff=7.1.3 utif=3.1.0
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
want libvips-tools 8.14.1
want libtiff-tools 4.5
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "tiff@$tiff" "utif@$utif" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "tiff $tiff or utif $utif cannot be had: not looked at"; exit 2; }
echo "version: tiff $tiff, utif $utif"
echo "expected: 0 pixels wrong in each"
# A wall of 64 x 48 pixels, 2000 to 2063 mm along its rows and one more a row.
node -e 'const d = Buffer.alloc(2 * 64 * 48); for (let i = 0; i < 64 * 48; i++) d.writeUInt16BE(2000 + i % 64 + (i >> 6), 2 * i);
process.stdout.write(Buffer.concat([Buffer.from("P5\n64 48\n65535\n"), d]))' >wall.pgm
tiles=tile,tile-width=16,tile-height=16
vips copy wall.pgm "tiles.tif[$tiles]" && vips copy wall.pgm "tiles-lzw.tif[$tiles,compression=lzw]" &&
  vips copy wall.pgm "tiles-deflate.tif[$tiles,compression=deflate]" && vips copy wall.pgm "strips-lzw.tif[compression=lzw]" &&
  vips copy wall.pgm "tiles-lzw-plain.tif[$tiles,compression=lzw,predictor=none]" || exit 2
tiffcp -c none tiles-lzw.tif back.tif || exit 2
for f in tiles-lzw strips-lzw; do echo "$f: $(tiffinfo $f.tif 2>/dev/null | grep -i predictor)"; done
cat >t.mjs <<'JS'
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { decode } from "tiff";

const UTIF = createRequire(import.meta.url)("utif");
const want = Array.from({ length: 64 * 48 }, (_, i) => 2000 + i % 64 + (i >> 6));
function byUtif(bytes) {
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), [page] = UTIF.decode(buffer);
  UTIF.decodeImage(buffer, page);
  const view = new DataView(page.data.buffer, page.data.byteOffset, page.data.length);
  return want.map((_, i) => view.getUint16(2 * i, true));
}
const wrong = (values) => want.filter((v, i) => values[i] !== v).length;
const seen = {};
for (const name of ["tiles", "tiles-lzw", "tiles-deflate", "tiles-lzw-plain", "strips-lzw", "back"]) {
  const bytes = readFileSync(`${name}.tif`), a = decode(bytes)[0].data, b = byUtif(bytes);
  seen[name] = [wrong(a), wrong(b)];
  console.log(`seen, ${name}: tiff ${wrong(a)} of ${want.length} pixels wrong, UTIF ${wrong(b)}; `
    + `tiff at columns 0, 16, 32, 48: ${[0, 16, 32, 48].map((x) => a[x])}`);
}
const first = decode(readFileSync("tiles-lzw.tif"))[0].data;
const stairs = [16, 32, 48].every((x, k) => first[x] > (k + 2) * 2000 && first[x] < (k + 2) * 2000 + 150);
const is = (name, n) => seen[name].every((v) => n ? v === n : v === 0);
process.exit(stairs && is("tiles-lzw", 2304) && is("tiles-deflate", 2304) && is("tiles") && is("tiles-lzw-plain") && is("strips-lzw")
  && is("back") ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: differences go on from tile to tile"
