#include "texture/astc.h"

#ifdef LMB_HAS_ASTCENC

/* Its header does not say that its functions have C's names, which Debian's library has. */
#include <cstddef>
#include <cstdint>
extern "C" {
#include <astcenc.h>
}

namespace {

constexpr unsigned side = 4;
const astcenc_swizzle whole = {ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_1};

size_t block_bytes(const astc_image *image)
{
    const size_t across = (static_cast<size_t>(image->width) + side - 1) / side;
    const size_t down = (static_cast<size_t>(image->height) + side - 1) / side;
    return 16 * across * down;
}

astcenc_image image_of(void **slice, const astc_image *image)
{
    *slice = image->rgba;
    astcenc_image made;
    made.dim_x = static_cast<unsigned>(image->width);
    made.dim_y = static_cast<unsigned>(image->height);
    made.dim_z = 1;
    made.data_type = ASTCENC_TYPE_F32;
    made.data = slice;
    return made;
}

/* NULL: no memory. */
astcenc_context *context_make(const astc_image *image, unsigned threads, unsigned flags)
{
    const astcenc_profile profile = image->high_range ? ASTCENC_PRF_HDR_RGB_LDR_A : ASTCENC_PRF_LDR;
    astcenc_config config;
    astcenc_context *context = nullptr;
    if (astcenc_config_init(profile, side, side, 1, ASTCENC_PRE_MEDIUM, flags, &config) != ASTCENC_SUCCESS ||
        astcenc_context_alloc(&config, threads, &context) != ASTCENC_SUCCESS) {
        return nullptr;
    }
    return context;
}

struct encode_work {
    astcenc_context *context;
    astcenc_image image;
    size_t size;
    unsigned char *bytes;
};

/* Each call takes blocks until there are none left. */
void encode_task(void *context, size_t task, int)
{
    encode_work *work = static_cast<encode_work *>(context);
    astcenc_compress_image(work->context, &work->image, &whole, work->bytes, work->size, static_cast<unsigned>(task));
}

} // namespace

bool lmb_astc_is_here(void)
{
    return true;
}

bool lmb_astc_encode(const astc_image *image, lmb_pool *pool, unsigned char *bytes)
try {
    void *slice;
    const unsigned threads = pool ? static_cast<unsigned>(lmb_pool_threads(pool)) : 1;
    encode_work work = {context_make(image, threads, 0), image_of(&slice, image), block_bytes(image), bytes};
    if (!work.context) {
        return false;
    }
    if (pool) {
        lmb_pool_run(pool, threads, encode_task, &work, "textures", nullptr);
    } else {
        encode_task(&work, 0, 0);
    }
    astcenc_context_free(work.context);
    return true;
} catch (...) {
    return false;
}

bool lmb_astc_decode(const unsigned char *bytes, astc_image *image)
try {
    void *slice;
    astcenc_image to = image_of(&slice, image);
    astcenc_context *context = context_make(image, 1, ASTCENC_FLG_DECOMPRESS_ONLY);
    const bool decoded =
        context && astcenc_decompress_image(context, bytes, block_bytes(image), &to, &whole, 0) == ASTCENC_SUCCESS;
    astcenc_context_free(context);
    return decoded;
} catch (...) {
    return false;
}

#else

bool lmb_astc_is_here(void)
{
    return false;
}

bool lmb_astc_encode(const astc_image *, lmb_pool *, unsigned char *)
{
    return false;
}

bool lmb_astc_decode(const unsigned char *, astc_image *)
{
    return false;
}

#endif
