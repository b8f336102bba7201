/* What is read of a level's file before anything of it is in a scene. */
#ifndef LMB_GLTF_DOCUMENT_HH
#define LMB_GLTF_DOCUMENT_HH

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include <lambent/gltf.h>

#include "gltf/gltf_accessor.h"
#include "gltf/gltf_extras.h"

namespace lmb_gltf {

/* What stops the loading. Thrown by everything in this namespace and caught in lmb_gltf_load, as std::bad_alloc is. */
struct failure {
    lmb_result result;
    lmb_error error;
};

/* Passes on what a function of C says. */
inline void check(lmb_result result, const lmb_error &error)
{
    if (result != LMB_OK) {
        throw failure{result, error};
    }
}

/* A scale of the options, of which 0 stands for 1. */
inline double scale_of(double told)
{
    return told > 0.0 ? told : 1.0;
}

struct document {
    lmb_gltf_file *const file; /* the caller's */
    const lmb_gltf_options &options;
    std::unique_ptr<lmb_gltf_marks[], void (*)(void *)> marks{nullptr, free}; /* [node] */
    tinygltf::Model model{};
    std::vector<const cJSON *> images{}, meshes{}; /* the items of these lists */

    std::string node_name(uint32_t index) const;
    std::vector<float> decode(uint32_t accessor) const;

    template <class... Args> [[noreturn]] void fail(lmb_result result, const char *format, Args... args) const
    {
        char what[LMB_ERROR_MESSAGE_SIZE];
        failure f;
        snprintf(what, sizeof what, format, args...);
        f.result = lmb_error_set(&f.error, result, "%s: %s", file->path, what);
        throw f;
    }
};

/* The scene's set of lights of a name that something in the file, `where`, has; 0 of an empty one, or, with a warning,
 * of one that is none. */
uint32_t light_set_of(const document &document, lmb_scene &scene, const char *name, const std::string &where,
                      const lmb_warnings &warnings);

/* The two steps that fill a document. The second takes the nodes out of the file's JSON. */
void read_marks(document &document);
void read_model(document &document);

} // namespace lmb_gltf

#endif
