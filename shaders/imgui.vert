#version 330 core
// One vertex of the interface, in display coordinates: origin top left, y down.
layout(location = 0) in vec2 position;
layout(location = 1) in vec2 texture_position;
layout(location = 2) in vec4 colour;

uniform mat4 clip_from_display;

out vec2 uv;
out vec4 tint;

void main() {
  uv = texture_position;
  tint = colour;
  gl_Position = clip_from_display * vec4(position, 0.0, 1.0);
}
