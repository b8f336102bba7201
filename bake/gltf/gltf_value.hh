/* What tinygltf leaves of extensions: their JSON, which was checked. Absent values are values that are nothing. */
#ifndef LMB_GLTF_VALUE_HH
#define LMB_GLTF_VALUE_HH

#include <map>
#include <string>

#include <tiny_gltf.h>

namespace lmb_gltf {

using tinygltf::Value;

const Value &find_extension(const tinygltf::ExtensionMap &extensions, const char *name);
const Value &member(const Value &object, const char *name);
double number(const Value &value, double missing);
int index_of(const Value &value); /* -1: none */

/* The accessor of an attribute, or -1. */
int32_t attribute(const std::map<std::string, int> &attributes, const char *name);

/* Texts of FLT_MAX are rounded up: what is too large is the largest float. */
float to_float(double value);

} // namespace lmb_gltf

#endif
