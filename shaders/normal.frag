#version 330 core
// The normal of a facet towards the viewer: any triangle soup has one, and both of its sides look
// alike. Light comes later, when what lies around is known.
in vec3 place;

out vec4 normal;

void main()
{
    // Steps to the right and up on the screen: their cross product points to the viewer.
    vec3 facet = cross(dFdx(place), dFdy(place));
    float size = length(facet);
    normal = vec4(0.5 + 0.5 * (size > 0.0 ? facet / size : vec3(0.0, 0.0, 1.0)), 1.0);
}
