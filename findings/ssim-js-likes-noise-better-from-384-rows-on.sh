#!/usr/bin/env bash
# ssim.js finds the same noise half as bad from 384 rows on
#
# One would swear: SSIM of a picture and the same with noise hangs on the noise; a whole picture and
#   a crop of it, of one kind everywhere, have the same, and it is about what scikit-image has.
# What happens: as it comes ssim.js halves pictures whose smaller side is 384 or more before it
#   compares, and averages of four pixels have half of the noise; moreover its usual measure, "weber",
#   is another one than SSIM. Noise of 10 grey levels has 0.65 at 480 x 360 and at 512 x 383, and 0.95
#   at 512 x 384 and at 640 x 480; scikit-image by the paper's weights has 0.49 for all of them. With
#   ssim "original" and downsample false it is 0.49 here as well. image-ssim, beside it, has about
#   0.56 for all.
# What follows: name both options, and say them beside the number; renderings of 640 x 480 compared by
#   this are not to be put beside a paper's, nor beside those of 320 x 240.
set -u
version=3.5.0 other=0.2.0
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
want python3-skimage 0.19.3
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "ssim.js@$version" "image-ssim@$other" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "ssim.js $version or image-ssim $other cannot be had: not looked at"; exit 2; }
echo "version: ssim.js $(node -p 'require("./node_modules/ssim.js/package.json").version'), image-ssim $other"
echo "expected: one number for every size"
cat >t.py <<'PY'
import json

import numpy as np
from skimage.metrics import structural_similarity

rng = np.random.default_rng(1)
y, x = np.mgrid[0:480, 0:640]
whole = np.clip(128 + 40 * np.sin(x / 15) + 30 * np.cos(y / 11), 0, 255)
noisy = np.clip(whole + rng.normal(0, 10, whole.shape), 0, 255)
sizes = [(240, 180), (480, 360), (512, 383), (512, 384), (640, 480)]
for k, (w, h) in enumerate(sizes):
    for name, picture in (("a", whole), ("b", noisy)):
        p = picture[:h, :w].round().astype(np.uint8)
        np.dstack([p, p, p, np.full_like(p, 255)]).tofile(f"{name}{k}.raw")
ours = [structural_similarity(whole[:h, :w].round(), noisy[:h, :w].round(), gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
                              data_range=255) for w, h in sizes]
print(json.dumps({"sizes": sizes, "skimage": ours}))
PY
cat >t.js <<'JS'
const { readFileSync } = require("node:fs"), { ssim } = require("ssim.js"), { compare } = require("image-ssim");

const { sizes, skimage } = JSON.parse(readFileSync("sizes.json", "utf8"));
const seen = sizes.map(([width, height], k) => {
  const [a, b] = ["a", "b"].map((name) => ({ data: new Uint8ClampedArray(readFileSync(`${name}${k}.raw`)), width, height, channels: 4 }));
  const r = { plain: ssim(a, b).mssim, weber: ssim(a, b, { downsample: false }).mssim,
    paper: ssim(a, b, { ssim: "original", downsample: false }).mssim, halved: ssim(a, b, { ssim: "original" }).mssim,
    windows: compare(a, b).ssim, skimage: skimage[k] };
  console.log(`seen, ${width} x ${height}: ` + Object.entries(r).map(([name, v]) => `${name} ${v.toFixed(3)}`).join(", "));
  return r;
});
const near = (a, b, e = 0.02) => Math.abs(a - b) < e, small = seen.slice(0, 3), large = seen.slice(3);
process.exit(small.every((r) => near(r.plain, 0.65) && near(r.halved, r.paper, 1e-9)) && large.every((r) => near(r.plain, 0.95) && r.halved > 0.85)
  && seen.every((r) => near(r.weber, 0.65) && near(r.paper, 0.49) && near(r.skimage, 0.49) && near(r.windows, seen[0].windows)) ? 0 : 1);
JS
/usr/bin/python3 t.py >sizes.json && nice node t.js 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: larger pictures have less noise"
