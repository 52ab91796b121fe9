#!/usr/bin/env bash
# Octave's imtranslate by half a pixel leaves a grey surface
#
# One would swear: a shift by Fourier interpolation is exact for a periodic picture, for half a pixel as
#   for a whole one; that is what one makes it for, to have pictures whose sub-pixel shift is known.
# What happens: whole shifts are exact. Between them the phase is laid on frequencies counted from 0 to
#   n - 1, where the upper half of them stands for negative ones, and what is imaginary afterwards is
#   dropped: by a shift of d all contrast is multiplied by cos(pi d) and every wave's phase is turned
#   by half a turn times d besides. At 0.5 a picture of waves of 10 about 100 is 100 everywhere, to
#   the last digit; at 0.25 it has 0.71 of its contrast and its waves, of 21 pixels, lie 2.7 pixels
#   from where they belong. It says nothing. With the frequencies counted on both sides of 0 the
#   same lines are exact to 1e-13.
# What follows: flow and correlation are not to be tried on pictures from imtranslate; interp2, or
#   phases counted on both sides of 0, will do. An accuracy that is best for whole pixels and nothing at
#   half of one may come from the pictures.
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
want octave 7.3.0
want octave-image 2.14.0
echo "expected: an error of 0 for each shift"
cat >"$tmp/t.m" <<'M'
pkg load image
n = 64;
x = repmat(0:n - 1, n, 1);
scene = @(d) 100 + 10 * sin(2 * pi * 3 * (x - d) / n);
% The shift to the right with frequencies on both sides of 0.
k = ifftshift(-n / 2:n / 2 - 1);
own = @(d) real(ifft2(fft2(scene(0)) .* repmat(exp(-2i * pi * k * d / n), n, 1)));
ok = true;
for d = [0 0.25 0.5 0.75 1 2 2.5]
  got = imtranslate(scene(0), d, 0);
  err = max(abs((got - scene(d))(:)));
  contrast = (max(got(:)) - min(got(:))) / 20;
  f = fft(got(1, :))(4);  % of the three waves
  lag = mod(-(arg(f) + pi / 2) / (2 * pi * 3 / n) - d + n / 6, n / 3) - n / 6;
  beside = max(abs((own(d) - scene(d))(:)));
  printf("seen, shift %g: off by up to %.3f, %.3f of the contrast, waves %.2f px from their place; beside it, both sides of 0: %.0e\n", ...
         d, err, contrast, lag * (contrast > 1e-6), beside);
  whole = d == round(d);
  ok = ok && beside < 1e-12 && abs(contrast - abs(cos(pi * d))) < 5e-3 && (whole && err < 1e-12 || !whole && err > 5);
  if d == 0.25
    ok = ok && abs(abs(lag) - 64 / 3 / 8) < 0.3;
  end
end
down = imtranslate(scene(0)', 0, 0.5);
printf("seen, 0.5 along the columns: %.3f of the contrast\n", (max(down(:)) - min(down(:))) / 20);
exit(!(ok && max(down(:)) - min(down(:)) < 1e-9));
M
(cd "$tmp" && nice octave --no-gui -qf t.m 2>octave.log) || { tail -3 "$tmp/octave.log"; echo "the behaviour has changed"; exit 1; }
echo "as described: half a pixel leaves nothing"
