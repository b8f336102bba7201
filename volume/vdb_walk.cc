// A walk over a .vdb file before OpenVDB reads it. OpenVDB 10 believes what a file says of lengths: it takes 4 GiB for
// a name, writes a Blosc block past the end of its buffer, and forgets a child of the root whose values cannot be
// decompressed. Here every count and length is held to the file's size and to what it is read into, and what would be
// forgotten is decompressed once before; nothing of what is walked over is kept.
//
//     file     header, metadata, number of grids, grids
//     grid     name, type, parent, three positions, compression, metadata, transform, then, unless it has the tree of a
//              parent: topology, buffers
//     topology number of buffers, background, tiles, nodes of 32^3 that hold nodes of 16^3 that hold leaves of 8^3
//     buffers  of each leaf: mask, values
#include "vdb_internal.hh"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <vector>

#include <openvdb/io/Compression.h>

namespace lmb_vdb {
namespace {

// Versions whose nodes are compressed by masks; OpenVDB 10 writes the last.
constexpr uint32_t kFirstVersion = 222, kLastVersion = 224;

enum Compression : uint32_t { kZip = 1, kActiveMask = 2, kBlosc = 4, kAnyCompression = 7 };

// A block of Blosc begins with four bytes and three lengths: of its contents, of its parts, of itself.
constexpr uint64_t kBloscHeader = 16;
// Fewer bytes than these are filled up to so many in metadata.
constexpr uint64_t kBloscPadded = 128;

// Tiles of a few bytes stand for any number of probes. Other tools make some where many probes are the same; nobody
// makes so many that a file's bytes are this few.
constexpr uint64_t kProbesInTiles = uint64_t(1) << 20, kProbesPerByte = 64;

constexpr int32_t kRootChild = 4096; // voxels along a child of the root

[[noreturn]] void fail_damaged(const std::string &what)
{
    fail(LMB_ERROR_FORMAT, "damaged: " + what);
}

// The file's bytes, none beyond its end.
class Source {
  public:
    explicit Source(const std::string &path) : file_(path, std::ios::binary)
    {
        file_.seekg(0, std::ios::end);
        const std::streamoff end = file_.tellg();
        size_ = end > 0 ? static_cast<uint64_t>(end) : 0;
        file_.seekg(0);
    }
    uint64_t size() const
    {
        return size_;
    }
    uint64_t at() const
    {
        return at_;
    }
    void read(void *bytes, uint64_t count)
    {
        take(count);
        file_.read(static_cast<char *>(bytes), static_cast<std::streamsize>(count));
        check_stream();
    }
    void seek(uint64_t to)
    {
        at_ = 0;
        take(to);
        file_.seekg(static_cast<std::streamoff>(to));
        check_stream();
    }
    void skip(uint64_t count)
    {
        take(count);
        file_.ignore(static_cast<std::streamsize>(count));
        check_stream();
    }
    template <typename T> T value()
    {
        T read_value;
        read(&read_value, sizeof read_value);
        return read_value;
    }
    // A length of 32 bits and as many bytes.
    std::string text()
    {
        const uint32_t length = value<uint32_t>();
        check(length);
        std::string read_text(length, '\0');
        read(&read_text[0], length);
        return read_text;
    }
    // Has OpenVDB decompress the block that ends here and began, with its length, at `begin`.
    void decompress(uint64_t begin, uint64_t bytes, uint32_t compression)
    {
        std::vector<char> values(bytes);
        file_.seekg(static_cast<std::streamoff>(begin));
        try {
            if (compression & kBlosc) {
                openvdb::io::bloscFromStream(file_, values.data(), bytes);
            } else {
                openvdb::io::unzipFromStream(file_, values.data(), bytes);
            }
        } catch (const openvdb::Exception &) {
            fail_damaged("a node's values cannot be decompressed");
        }
        seek(at_);
    }
    // So many bytes are still to come.
    void check(uint64_t count) const
    {
        if (count > size_ - at_) {
            fail(LMB_ERROR_FORMAT, "the file is cut short");
        }
    }

  private:
    void take(uint64_t count)
    {
        check(count);
        at_ += count;
    }
    void check_stream() const
    {
        if (!file_) {
            fail(LMB_ERROR_FORMAT, "the file is cut short");
        }
    }

    std::ifstream file_;
    uint64_t size_ = 0, at_ = 0;
};

// A kind of grid that is walked over, as it is named in files; one that is saved as halves has a suffix.
struct Kind {
    const char *name;
    uint64_t value_bytes, half_bytes;
};
constexpr Kind kKinds[] = {{"Tree_float_5_4_3", 4, 2}, {"Tree_vec3s_5_4_3", 12, 6}};
constexpr const char *kHalfSuffix = "_HalfFloat";
// What follows a name that several grids have: a record separator, and a number.
constexpr char kNameEnd = '\x1e';

// How a grid's values are stored.
struct Storage {
    Kind kind;
    uint32_t compression;
    bool halves;
};

// A node's mask of 8^3, 16^3 or 32^3 bits.
struct Mask {
    uint64_t word[512];
    size_t words;
};

void read_mask(Source &source, uint32_t bits, Mask &mask)
{
    mask.words = bits / 64;
    source.read(mask.word, bits / 8);
}

uint32_t count_on(const Mask &mask)
{
    uint32_t count = 0;
    for (size_t i = 0; i < mask.words; ++i) {
        for (uint64_t word = mask.word[i]; word; word &= word - 1) {
            ++count;
        }
    }
    return count;
}

bool have_common(const Mask &a, const Mask &b)
{
    for (size_t i = 0; i < a.words; ++i) {
        if (a.word[i] & b.word[i]) {
            return true;
        }
    }
    return false;
}

// ------------------------------------------------------------------------------------------------- compressed

// A block that says of itself what is known of it: Blosc checks the rest.
void skip_blosc(Source &source, uint64_t length, uint64_t contents)
{
    if (length < kBloscHeader) {
        fail_damaged("a Blosc block is too short");
    }
    source.skip(4);
    const uint32_t says_contents = source.value<uint32_t>();
    source.skip(4);
    if (says_contents != contents || source.value<uint32_t>() != length) {
        fail_damaged("a Blosc block lies about its length");
    }
    source.skip(length - kBloscHeader);
}

// `bytes` of values, compressed or not; `tries`: to see that they can be decompressed.
void skip_data(Source &source, uint64_t bytes, uint32_t compression, bool tries)
{
    const uint64_t begin = source.at();
    if (!(compression & (kBlosc | kZip))) {
        source.skip(bytes);
        return;
    }
    const int64_t length = source.value<int64_t>(); // what is not compressed has a negative one
    if (length <= 0) {
        if (uint64_t(0) - static_cast<uint64_t>(length) != bytes) {
            fail_damaged("values are of another length than their node");
        }
        source.skip(bytes);
    } else if (compression & kBlosc) {
        skip_blosc(source, static_cast<uint64_t>(length), bytes);
    } else {
        source.skip(static_cast<uint64_t>(length)); // zlib is told how large its buffer is
    }
    if (tries && length > 0) {
        source.decompress(begin, bytes, compression);
    }
}

// A node's values: what the inactive ones are, then those of `mask` or all.
void skip_values(Source &source, const Mask &mask, const Storage &storage, bool tries)
{
    // none, -background, one value, mask, mask and one value, mask and two values, all values are here
    static constexpr struct {
        uint32_t values;
        bool mask;
    } extra[] = {{0, false}, {0, false}, {1, false}, {0, true}, {1, true}, {2, true}, {0, false}};
    const uint8_t inactive = source.value<uint8_t>();
    if (inactive >= std::size(extra)) {
        fail_damaged("a node says nothing known of its inactive values");
    }
    source.skip(extra[inactive].values * storage.kind.value_bytes);
    source.skip(extra[inactive].mask ? mask.words * 8 : 0);
    const bool has_all = !(storage.compression & kActiveMask) || inactive == std::size(extra) - 1;
    const uint64_t count = has_all ? mask.words * 64 : count_on(mask);
    if (!storage.halves) {
        skip_data(source, count * storage.kind.value_bytes, storage.compression, tries);
    } else if (count > 0) { // of no halves there is not even a length
        skip_data(source, count * storage.kind.half_bytes, storage.compression, tries);
    }
}

// --------------------------------------------------------------------------------------------------- metadata

// What a tool noted about where leaves are: their number, then two arrays with an element for each.
void skip_leaf_places(Source &source, uint32_t length)
{
    const uint64_t end = source.at() + length;
    if (length == 0) {
        return;
    }
    const uint32_t leaves = source.value<uint32_t>();
    source.check(leaves);
    for (const uint64_t element : {1, 8}) {
        const uint64_t bytes = leaves * element;
        const uint32_t compressed = source.value<uint32_t>();
        if (compressed == UINT32_MAX && element == 8) {
            continue; // left out
        }
        if (compressed == 0) {
            source.skip(bytes);
            continue;
        }
        skip_blosc(source, compressed, std::max(bytes, kBloscPadded));
    }
    if (source.at() != end) {
        fail_damaged("metadata is of another length than it says");
    }
}

// Bytes of a value, or 0: any number.
uint32_t metadata_bytes(const std::string &type)
{
    static constexpr struct {
        const char *name;
        uint32_t bytes;
    } types[] = {{"string", 0}, {"bool", 1},   {"int32", 4},  {"int64", 8},  {"float", 4},  {"double", 8},
                 {"vec2i", 8},  {"vec2s", 8},  {"vec2d", 16}, {"vec3i", 12}, {"vec3s", 12}, {"vec3d", 24},
                 {"vec4i", 16}, {"vec4s", 16}, {"vec4d", 32}, {"mat4s", 64}, {"mat4d", 128}};
    for (const auto &known : types) {
        if (type == known.name) {
            return known.bytes;
        }
    }
    fail(LMB_ERROR_FORMAT, "has metadata of a type that Lambent does not read: " + type.substr(0, 64));
}

// @return whether it says that values are saved as halves
bool skip_metadata(Source &source)
{
    bool halves = false;
    for (uint32_t left = source.value<uint32_t>(); left > 0; --left) {
        const std::string name = source.text(), type = source.text();
        const uint32_t length = source.value<uint32_t>();
        if (type == "__delayedload") {
            skip_leaf_places(source, length);
            continue;
        }
        const uint32_t bytes = metadata_bytes(type);
        if (bytes > 0 && bytes != length) {
            fail_damaged("metadata is of another length than its type");
        }
        const bool says_half = name == "is_saved_as_half_float";
        if (says_half && type != "bool") {
            fail_damaged("is_saved_as_half_float is no bool");
        }
        if (type != "bool") {
            source.skip(length);
            continue;
        }
        const uint8_t truth = source.value<uint8_t>();
        if (truth > 1) {
            fail_damaged("a bool is neither true nor false");
        }
        halves = says_half ? truth == 1 : halves;
    }
    return halves;
}

void skip_transform(Source &source)
{
    static constexpr struct {
        const char *name;
        uint64_t bytes;
    } maps[] = {{"UniformScaleMap", 120},   {"ScaleMap", 120},      {"UniformScaleTranslateMap", 144},
                {"ScaleTranslateMap", 144}, {"TranslationMap", 24}, {"AffineMap", 128},
                {"UnitaryMap", 128}};
    const std::string name = source.text();
    for (const auto &map : maps) {
        if (name == map.name) {
            source.skip(map.bytes);
            return;
        }
    }
    fail(LMB_ERROR_FORMAT, "has a transform that Lambent does not read: " + name.substr(0, 64));
}

// ------------------------------------------------------------------------------------------------------- trees

// A tree, whose leaves' number is known once its topology is behind.
struct Tree {
    Storage storage;
    uint64_t leaves, probes_in_tiles;
};

// A node of `bits` and all below it: nodes of 16^3 in one of 32^3, leaves in these.
void skip_node(Source &source, uint32_t bits, Tree &tree)
{
    constexpr uint32_t leaf_bits = 512, lower_bits = 4096;
    Mask children, values;
    read_mask(source, bits, children);
    read_mask(source, bits, values);
    if (have_common(children, values)) {
        fail_damaged("a node has a tile where it has a child");
    }
    const bool is_lower = bits == lower_bits;
    tree.probes_in_tiles += uint64_t(count_on(values)) * leaf_bits * (is_lower ? 1 : lower_bits);
    if (tree.probes_in_tiles > kProbesInTiles + kProbesPerByte * source.size()) {
        fail(LMB_ERROR_FORMAT, "holds too many probes");
    }
    skip_values(source, values, tree.storage, true);
    const uint32_t count = count_on(children);
    if (is_lower) {
        source.skip(uint64_t(count) * leaf_bits / 8);
        tree.leaves += count;
        return;
    }
    for (uint32_t child = 0; child < count; ++child) {
        skip_node(source, lower_bits, tree);
    }
}

struct Place {
    int32_t at[3];
};

// Of a child of the root, which are in order, so that buffers are in the order of nodes.
void read_place(Source &source, bool is_first, Place &last)
{
    const Place place = source.value<Place>();
    const bool is_behind = is_first || std::lexicographical_compare(last.at, last.at + 3, place.at, place.at + 3);
    if (!is_behind || std::any_of(place.at, place.at + 3, [](int32_t at) { return at % kRootChild != 0; })) {
        fail_damaged("the root's children are out of place");
    }
    last = place;
}

void skip_root(Source &source, Tree &tree)
{
    constexpr uint32_t upper_bits = 32768;
    if (source.value<int32_t>() != 1) {
        fail_damaged("a tree has not one buffer");
    }
    source.skip(tree.storage.kind.value_bytes); // the background
    const uint32_t tiles = source.value<uint32_t>(), children = source.value<uint32_t>();
    Place last{};
    for (uint32_t tile = 0; tile < tiles; ++tile) {
        read_place(source, tile == 0, last);
        source.skip(tree.storage.kind.value_bytes);
        if (source.value<uint8_t>() != 0) {
            fail(LMB_ERROR_FORMAT, "holds too many probes"); // 4096^3
        }
    }
    for (uint32_t child = 0; child < children; ++child) {
        read_place(source, child == 0, last);
        skip_node(source, upper_bits, tree);
    }
}

void skip_tree(Source &source, const Storage &storage)
{
    Tree tree{storage, 0, 0};
    skip_root(source, tree);
    for (uint64_t leaf = 0; leaf < tree.leaves; ++leaf) {
        Mask mask;
        read_mask(source, 512, mask);
        skip_values(source, mask, storage, false);
    }
}

// ------------------------------------------------------------------------------------------------------- grids

Kind find_kind(const std::string &name, const std::string &type)
{
    const size_t suffix = std::strlen(kHalfSuffix);
    const bool has_suffix = type.size() > suffix && type.compare(type.size() - suffix, suffix, kHalfSuffix) == 0;
    const std::string stem = type.substr(0, type.size() - (has_suffix ? suffix : 0));
    for (const Kind &kind : kKinds) {
        if (stem == kind.name) {
            return kind;
        }
    }
    fail(LMB_ERROR_FORMAT,
         "grid " + name.substr(0, 64) + " is of type " + stem.substr(0, 64) + ", which Lambent does not read");
}

// What comes before a grid: names, and positions of its begin, its buffers and its end.
struct Descriptor {
    std::string name, type, parent;
    uint64_t position[3];
};

Descriptor read_descriptor(Source &source)
{
    Descriptor read{source.text(), source.text(), source.text(), {}};
    source.read(read.position, sizeof read.position);
    return read;
}

// Goes from grid to grid by their positions.
void check_names(Source &source, int32_t grids)
{
    const uint64_t begin = source.at();
    bool is_ours = false;
    for (int32_t grid = 0; grid < grids; ++grid) {
        const Descriptor descriptor = read_descriptor(source);
        is_ours = is_ours || descriptor.name.compare(0, descriptor.name.find(kNameEnd), "sh_0") == 0;
        source.seek(descriptor.position[2]);
    }
    if (!is_ours) {
        fail(LMB_ERROR_FORMAT, "not written by Lambent: has no grid sh_0");
    }
    source.seek(begin);
}

void skip_grid(Source &source, bool has_positions)
{
    const Descriptor descriptor = read_descriptor(source);
    const Kind kind = find_kind(descriptor.name, descriptor.type);
    const uint64_t begin = source.at();
    const uint32_t compression = source.value<uint32_t>();
    if (compression > kAnyCompression) {
        fail_damaged("a grid is compressed in an unknown way");
    }
    const bool halves = skip_metadata(source);
    skip_transform(source);
    if (descriptor.parent.empty()) {
        skip_tree(source, {kind, compression, halves});
    }
    if (has_positions && (descriptor.position[0] != begin || descriptor.position[2] != source.at())) {
        fail_damaged("a grid is not where the file says");
    }
}

// Letters of 8-4-4-4-12: whatever else would be read as less or more.
bool is_uuid(const char text[kUuidLength])
{
    for (size_t i = 0; i < kUuidLength; ++i) {
        const bool is_hyphen = i == 8 || i == 13 || i == 18 || i == 23;
        if (text[i] == '\0' || !std::strchr(is_hyphen ? "-" : "0123456789abcdefABCDEF", text[i])) {
            return false;
        }
    }
    return true;
}

} // namespace

void check_structure(const std::string &path)
{
    Source source(path);
    source.skip(8); // the magic
    const uint32_t version = source.value<uint32_t>();
    if (version < kFirstVersion || version > kLastVersion) {
        fail(LMB_ERROR_FORMAT, "is of version " + std::to_string(version) + " of the .vdb format; Lambent reads " +
                                   std::to_string(kFirstVersion) + " to " + std::to_string(kLastVersion));
    }
    source.skip(8); // of the library
    const bool has_positions = source.value<uint8_t>() != 0;
    char uuid[kUuidLength];
    source.read(uuid, sizeof uuid);
    if (!is_uuid(uuid)) {
        fail_damaged("the file has no UUID");
    }
    skip_metadata(source);
    const int32_t grids = source.value<int32_t>();
    if (grids < 0) {
        fail_damaged("a negative number of grids");
    }
    source.check(static_cast<uint64_t>(grids));
    if (has_positions) {
        check_names(source, grids);
    }
    for (int32_t grid = 0; grid < grids; ++grid) {
        skip_grid(source, has_positions);
    }
}

} // namespace lmb_vdb
