/* Makes the textures of a volume for a GPU, and says what an engine has to upload:
 *
 *     volume_texture FILE.lmb [OUTPUT]
 *
 * With a name, OUTPUT.texels, OUTPUT.words and OUTPUT.constants get the bytes: half floats for 3D textures of the
 * format RGBA16F (VK_FORMAT_R16G16B16A16_SFLOAT, DXGI_FORMAT_R16G16B16A16_FLOAT), words for a storage buffer, and a
 * uniform buffer, for sampler/shader/lambent_volume_texture.glsl. */
#include <stdio.h>
#include <stdlib.h>

#include <lambent/volume_texture.h>

static bool file_write(const char *name, const char *end, const void *bytes, size_t count)
{
    char path[4096];
    const int length = snprintf(path, sizeof path, "%s.%s", name, end);
    if (length < 0 || (size_t)length >= sizeof path) {
        return false;
    }
    FILE *const file = fopen(path, "wb");
    const bool written = file && fwrite(bytes, 1, count, file) == count;
    return file && fclose(file) == 0 && written;
}

static bool texture_make(const lmb_volume *volume, const char *output)
{
    const lmb_volume_texture_def def = lmb_volume_texture_default();
    const lmb_volume_info info = lmb_volume_get_info(volume);
    lmb_volume_texture_layout layout;
    const lmb_result result = lmb_volume_texture_size(volume, &def, &layout);
    if (result != LMB_OK) {
        fprintf(stderr, "volume_texture: %s\n", lmb_result_text(result));
        return false;
    }
    const uint64_t bytes = layout.texture_bytes + UINT64_C(4) * layout.word_count;
    printf("%u textures of %u x %u x %u texels, RGBA16F, %llu bytes, and %u words\n", layout.parts, layout.width,
           layout.height, layout.depth, (unsigned long long)layout.texture_bytes, layout.word_count);
    printf("%u bricks, %u regions of %u cut cells; %.1f bytes a probe, the file %.1f\n", info.brick_count,
           layout.regions, info.cut_count, (double)bytes / (double)info.probe_count,
           (double)info.file_bytes / (double)info.probe_count);
    if (!output) {
        return true;
    }
    uint16_t *const texels = malloc((size_t)layout.texture_bytes); /* an engine has staging memory for both */
    uint32_t *const words = malloc(layout.word_count * sizeof *words);
    bool made = texels && words;
    if (made) {
        lmb_volume_texture_fill(volume, &layout, texels, words);
        const lmb_volume_texture_constants constants =
            lmb_volume_texture_get_constants(volume, &layout, (lmb_vec3d){0.0, 0.0, 0.0});
        made = file_write(output, "texels", texels, (size_t)layout.texture_bytes) &&
               file_write(output, "words", words, layout.word_count * sizeof *words) &&
               file_write(output, "constants", &constants, sizeof constants);
    }
    if (!made) {
        fprintf(stderr, "volume_texture: no memory, or %s cannot be written\n", output);
    }
    free(texels);
    free(words);
    return made;
}

int main(int count, char **values)
{
    if (count != 2 && count != 3) {
        fprintf(stderr, "usage: volume_texture FILE.lmb [OUTPUT]\n");
        return 2;
    }
    lmb_volume *volume;
    const lmb_result opened = lmb_volume_open_file(values[1], &volume);
    if (opened != LMB_OK) {
        fprintf(stderr, "volume_texture: %s: %s\n", values[1], lmb_result_text(opened));
        return 1;
    }
    const bool made = texture_make(volume, count == 3 ? values[2] : NULL);
    lmb_volume_close(volume);
    return made ? 0 : 1;
}
