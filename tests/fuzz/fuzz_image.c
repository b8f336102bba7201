/* Pictures: OpenEXR of every compression and Radiance .hdr, as environments are read; and of OpenEXR any channels, as
 * lightmaps are. */
#include "fuzz.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include <OpenEXR/ImfCRgbaFile.h>
#include <lambent/exr.h>

#include "image/exr_internal.h"
#include "image/image_internal.h"

static void picture_decode(const lmb_image_bytes *file)
{
    lmb_image image = {0, 0, NULL};
    lmb_latlong_axes axes;
    size_t bad = 0;
    lmb_error error = {{0}};
    const lmb_result result = lmb_image_decode(file, &image, &axes, &bad, &error);
    FUZZ_CHECK(result == LMB_OK || (error.message[0] != '\0' && !image.rgb), "result %d without a message", result);
    const size_t values = result == LMB_OK ? 3 * (size_t)image.width * (size_t)image.height : 0;
    bool good = true;
    for (size_t i = 0; i < values; ++i) {
        good = good && image.rgb[i] >= 0.0f && isfinite(image.rgb[i]);
    }
    FUZZ_CHECK(good, "NaN, infinite or negative light");
    lmb_image_free(&image);
}

static void channels_decode(const lmb_image_bytes *file)
{
    static const char *const names[] = {"B", "R"};
    float *values[2] = {NULL, NULL};
    lmb_exr_header header;
    lmb_error error = {{0}};
    if (lmb_exr_decode_channels(file, names, 2, values, &header, &error) == LMB_OK) {
        FUZZ_CHECK(header.width > 0 && header.height > 0, "%d x %d", header.width, header.height);
        free(values[0]);
        free(values[1]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const lmb_image_bytes file = {"input", data, size};
    picture_decode(&file);
    channels_decode(&file);
    return 0;
}

enum { WIDTH = 24, HEIGHT = 12 };

/* Half RGBA by OpenEXR's C++ library, which writes all of its compressions. */
static void exr_seed(int compression)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/fuzz_seed.exr";
    ImfRgba pixels[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        ImfFloatToHalf(0.1f * (float)(i % WIDTH), &pixels[i].r);
        ImfFloatToHalf(0.5f * (float)(i / WIDTH), &pixels[i].g);
        ImfFloatToHalf((float)(i * i % 17), &pixels[i].b);
        ImfFloatToHalf(1.0f, &pixels[i].a);
    }
    ImfHeader *const header = ImfNewHeader();
    ImfHeaderSetDisplayWindow(header, 0, 0, WIDTH - 1, HEIGHT - 1);
    ImfHeaderSetDataWindow(header, 0, 0, WIDTH - 1, HEIGHT - 1);
    ImfHeaderSetCompression(header, compression);
    ImfOutputFile *const file = ImfOpenOutputFile(path, header, IMF_WRITE_RGBA);
    FUZZ_CHECK(file && ImfOutputSetFrameBuffer(file, pixels, 1, WIDTH) && ImfOutputWritePixels(file, HEIGHT), "%s",
               path);
    ImfDeleteHeader(header);
    FUZZ_CHECK(ImfCloseOutputFile(file), "%s", path);
    fuzz_seed_file(path);
    remove(path);
}

/* A flat and a run-length coded picture. */
static void hdr_seeds(void)
{
    static const char flat[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n"
                               "abcdefghijklmnopqrstuvwxyzABCDEF";
    unsigned char coded[128] = "#?RGBE\n\n+X 2 -Y 16\n";
    size_t size = strlen((const char *)coded);
    for (int line = 0; line < 2; ++line) {
        static const unsigned char scanline[] = {2, 2, 0, 16, 144, 7, 144, 8, 4, 1, 2, 3, 4, 140, 9, 144, 128};
        memcpy(coded + size, scanline, sizeof scanline);
        size += sizeof scanline;
    }
    fuzz_seed(flat, sizeof flat - 1);
    fuzz_seed(coded, size);
}

void fuzz_seeds(void)
{
    for (int compression = 0; compression < 10; ++compression) {
        exr_seed(compression);
    }
    hdr_seeds();
}
