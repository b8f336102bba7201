#version 450
// Reads a texture: an item is four numbers, column and row of a texel, layer and level; out come the texel as it is, and
// what filtering gives at its lower right corner.
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) readonly buffer Input { vec4 item[]; };
layout(set = 0, binding = 1) buffer Output { vec4 seen[]; };
layout(set = 0, binding = 2) uniform sampler2DArray image;

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= item.length()) {
        return;
    }
    vec4 at = item[i];
    int level = int(at.w);
    vec2 size = vec2(textureSize(image, level).xy);
    seen[2 * i] = texelFetch(image, ivec3(at.xyz), level);
    seen[2 * i + 1] = textureLod(image, vec3((at.xy + 1.0) / size, at.z), at.w);
}
