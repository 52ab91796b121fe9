#version 330 core
// A round point with a soft edge.
in vec4 point_colour;

uniform float size_px;

out vec4 colour;

void main() {
  float from_centre = length(gl_PointCoord - 0.5) * (size_px + 1.0);
  float coverage = clamp(0.5 * size_px + 0.5 - from_centre, 0.0, 1.0);
  if (coverage <= 0.0) discard;
  colour = vec4(point_colour.rgb, point_colour.a * coverage);
}
