#version 330 core
// A polygon of the occluder: the colour of its plane, a little lighter where it faces the viewer.
in vec3 place;
in vec3 paint;

out vec4 color;

void main()
{
    vec3 facet = cross(dFdx(place), dFdy(place));
    float size = length(facet);
    float facing = size > 0.0 ? facet.z / size : 1.0;
    color = vec4(paint * (0.75 + 0.25 * facing), 0.5);
}
