#version 330 core
// White: for images that only ask whether something is there.
out vec4 color;

void main()
{
    color = vec4(1.0);
}
