#version 330 core
in vec2 uv;

uniform sampler2D image;
uniform float opacity;

out vec4 colour;

void main() { colour = vec4(texture(image, uv).rgb, opacity); }
