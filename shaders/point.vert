#version 330 core
// A point of the map, the same size on the screen wherever it is, fainter far away.
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 colour;

uniform mat4 clip_from_world;
uniform float size_px;
uniform float reference_depth;  // m: nearer points have full strength

out vec4 point_colour;

void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  gl_PointSize = size_px + 1.0;  // room for the soft edge
  float fade = clamp(reference_depth / max(gl_Position.w, 1e-6), 0.3, 1.0);
  point_colour = vec4(colour.rgb, colour.a * fade);
}
