/* The arrays of a scene from C++: they stay malloc'ed, and whoever is out of memory throws std::bad_alloc. */
#ifndef LMB_GLTF_APPEND_HH
#define LMB_GLTF_APPEND_HH

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

namespace lmb_gltf {

inline char *copy_string(const std::string &text)
{
    char *const copy = static_cast<char *>(malloc(text.size() + 1));
    if (!copy) {
        throw std::bad_alloc();
    }
    memcpy(copy, text.c_str(), text.size() + 1);
    return copy;
}

/* A new zero element at the end of an array of the scene, which owns it from here on. Room doubles whenever the count
 * is a power of two. */
template <class T> T &append(T *&array, uint32_t &count)
{
    if ((count & (count - 1)) == 0) {
        void *const larger = realloc(array, std::max<size_t>(size_t(count) * 2, 1) * sizeof(T));
        if (!larger) {
            throw std::bad_alloc();
        }
        array = static_cast<T *>(larger);
    }
    memset(&array[count], 0, sizeof(T));
    return array[count++];
}

} // namespace lmb_gltf

#endif
