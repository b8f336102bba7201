#include "gltf/gltf_value.hh"

#include <algorithm>
#include <limits>

namespace lmb_gltf {

const Value &find_extension(const tinygltf::ExtensionMap &extensions, const char *name)
{
    static const Value none;
    const auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

const Value &member(const Value &object, const char *name)
{
    static const Value none;
    return object.IsObject() ? object.Get(name) : none;
}

double number(const Value &value, double missing)
{
    return value.IsNumber() ? value.GetNumberAsDouble() : missing;
}

int index_of(const Value &value)
{
    return value.IsNumber() ? value.GetNumberAsInt() : -1;
}

int32_t attribute(const std::map<std::string, int> &attributes, const char *name)
{
    const auto found = attributes.find(name);
    return found == attributes.end() ? -1 : found->second;
}

float to_float(double value)
{
    const double largest = double(std::numeric_limits<float>::max());
    return float(std::max(-largest, std::min(value, largest)));
}

} // namespace lmb_gltf
