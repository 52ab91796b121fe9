#version 330 core
// A line's pixel: covered by its distance to the segment, so edges are smooth and ends round.
noperspective in vec2 along_across;
flat in float length_px;
in vec4 line_colour;

uniform float width_px;

out vec4 colour;

void main() {
  vec2 nearest = vec2(clamp(along_across.x, 0.0, length_px), 0.0);
  // A line thinner than a pixel is drawn a pixel wide and fainter.
  float wide = max(width_px, 1.0);
  float coverage = clamp(0.5 * wide + 0.5 - distance(along_across, nearest), 0.0, 1.0) * min(width_px, 1.0);
  if (coverage <= 0.0) discard;
  colour = vec4(line_colour.rgb, line_colour.a * coverage);
}
