#version 330 core
// A square of one colour: nothing to weigh pixel by pixel.
flat in vec3 point_colour;

out vec4 colour;

void main() { colour = vec4(point_colour, 1.0); }
