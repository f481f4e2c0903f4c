#include "results/huffman_code.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

namespace carom::tool {
namespace {

struct Node {
    std::uint32_t weight;
    int parent;
};

/// Lengths of an unlimited Huffman code, by merging the two lightest of leaves (sorted) and inner nodes (made
/// in order of weight); returns the longest.
int find_lengths(std::span<const std::uint32_t, kLiteralSymbols> frequency, HuffmanCode& code) {
    std::vector<std::size_t> symbols;
    for (std::size_t symbol = 0; symbol < kLiteralSymbols; ++symbol)
        if (frequency[symbol] > 0) symbols.push_back(symbol);
    std::stable_sort(symbols.begin(), symbols.end(),
                     [&](std::size_t a, std::size_t b) { return frequency[a] < frequency[b]; });
    assert(symbols.size() >= 2);

    std::vector<Node> nodes;
    for (const std::size_t symbol : symbols) nodes.push_back({frequency[symbol], -1});
    std::size_t leaf = 0, inner = symbols.size();
    const auto take_lightest = [&] {
        const bool take_leaf =
            leaf < symbols.size() && (inner == nodes.size() || nodes[leaf].weight <= nodes[inner].weight);
        return take_leaf ? leaf++ : inner++;
    };
    for (std::size_t merged = 1; merged < symbols.size(); ++merged) {
        const std::size_t a = take_lightest(), b = take_lightest();
        nodes[a].parent = nodes[b].parent = static_cast<int>(nodes.size());
        nodes.push_back({nodes[a].weight + nodes[b].weight, -1});
    }

    std::vector<int> depth(nodes.size(), 0);
    int longest = 0;
    for (std::size_t node = nodes.size() - 1; node-- > 0;) {
        depth[node] = depth[static_cast<std::size_t>(nodes[node].parent)] + 1;
        longest = std::max(longest, depth[node]);
    }
    for (std::size_t i = 0; i < symbols.size(); ++i)
        code.length[symbols[i]] = static_cast<std::uint8_t>(std::min(depth[i], 255));
    return longest;
}

std::uint16_t reversed(unsigned code, int length) {
    unsigned result = 0;
    for (int i = 0; i < length; ++i) result |= (code >> i & 1u) << (length - 1 - i);
    return static_cast<std::uint16_t>(result);
}

/// Codes of one length count upwards in the order of symbols; shorter ones come first.
void assign_bits(HuffmanCode& code) {
    std::array<unsigned, kLongestCode + 1> count{}, next{};
    for (const std::uint8_t length : code.length) ++count[length];
    count[0] = 0;
    for (std::size_t length = 1; length <= kLongestCode; ++length)
        next[length] = (next[length - 1] + count[length - 1]) << 1;
    for (std::size_t symbol = 0; symbol < kLiteralSymbols; ++symbol)
        if (code.length[symbol] > 0)
            code.bits[symbol] = reversed(next[code.length[symbol]]++, code.length[symbol]);
}

}  // namespace

HuffmanCode make_huffman_code(std::span<const std::uint32_t, kLiteralSymbols> frequency) {
    HuffmanCode code;
    std::array<std::uint32_t, kLiteralSymbols> flatter;
    std::copy(frequency.begin(), frequency.end(), flatter.begin());
    // Too deep a tree is rare and costs little: flatter weights make it shallower.
    while (find_lengths(flatter, code) > kLongestCode)
        for (std::uint32_t& weight : flatter) weight = (weight + 1) / 2;
    assign_bits(code);
    return code;
}

}  // namespace carom::tool
