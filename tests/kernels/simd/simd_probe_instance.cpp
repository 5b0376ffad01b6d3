#include "tests/kernels/simd/simd_probe.hpp"

#include "lancet/kernels/simd/nodes.hpp"

namespace lancet::kernels::test {

namespace {

template <class P>
P apply(Operation operation, P a, P b, P c) {
    using Real = typename P::Real;
    switch (operation) {
        case Operation::add:
            return a + b;
        case Operation::subtract:
            return a - b;
        case Operation::multiply:
            return a * b;
        case Operation::divide:
            return a / b;
        case Operation::negate:
            return -a;
        case Operation::fma:
            return fma(a, b, c);
        case Operation::fnma:
            return fnma(a, b, c);
        case Operation::minimum:
            return min(a, b);
        case Operation::maximum:
            return max(a, b);
        case Operation::absolute:
            return abs(a);
        case Operation::root:
            return sqrt(a);
        case Operation::select_less:
            return select(a < b, a, c);
        case Operation::select_finite:
            return select(is_finite(a), P(Real(1)), P(Real(0)));
        case Operation::add_assign:
            return a += b;
        case Operation::subtract_assign:
            return a -= b;
        case Operation::multiply_assign:
            return a *= b;
        case Operation::load_store:
            return a;
        case Operation::broadcast:
            return P(Real(0.75));
    }
    return a;
}

template <class P>
auto compare(Comparison comparison, P a, P b) {
    switch (comparison) {
        case Comparison::less:
            return a < b;
        case Comparison::less_equal:
            return a <= b;
        case Comparison::greater:
            return a > b;
        case Comparison::greater_equal:
            return a >= b;
        case Comparison::equal:
            return a == b;
        case Comparison::less_and_equal:
            return (a < b) & (a == b);
        case Comparison::less_or_equal:
            return (a < b) | (a == b);
        case Comparison::not_less:
            return !(a < b);
    }
    return a < b;
}

template <class P>
struct Probe {
    using Real = typename P::Real;

    static void apply_to(Operation operation, const Real* a, const Real* b, const Real* c, Real* result) {
        apply(operation, P::load(a), P::load(b), P::load(c)).store(result);
    }
    static void compare_these(Comparison comparison, const Real* a, const Real* b, Real* ones, bool* anywhere,
                              bool* everywhere) {
        const auto mask = compare(comparison, P::load(a), P::load(b));
        select(mask, P(Real(1)), P(Real(0))).store(ones);
        *anywhere = any(mask);
        *everywhere = all(mask);
    }
    static Real sum_of(const Real* a) { return sum(P::load(a)); }
    static Real largest_of(const Real* a) { return largest(P::load(a)); }

    static void put(Vector3<P> v, Real* lanes) {
        v.x.store(lanes);
        v.y.store(lanes + P::width);
        v.z.store(lanes + 2 * P::width);
    }
    static Vector3<P> get(const Real* lanes) {
        return {P::load(lanes), P::load(lanes + P::width), P::load(lanes + 2 * P::width)};
    }
    static void load_indexed(const Real* nodal, const std::int32_t* index, Real* lanes) {
        put(load_nodes<P>(nodal, index), lanes);
    }
    static void load_row(const Real* nodal, Real* lanes) { put(load_nodes<P>(nodal), lanes); }
    static void store_indexed(Real* nodal, const std::int32_t* index, const Real* lanes) {
        store_nodes<P>(nodal, index, get(lanes));
    }
    static void store_row(Real* nodal, const Real* lanes) { store_nodes<P>(nodal, get(lanes)); }
    static void add_indexed(Real* nodal, const std::int32_t* index, const Real* lanes) {
        add_to_nodes<P>(nodal, index, get(lanes));
    }
    static void differences(const double* nodal, const std::int32_t* index, const std::int32_t* origin, Real* lanes) {
        put(load_differences<P>(nodal, index, origin), lanes);
    }
    static void differences_of_rows(const double* rows, const std::int32_t* index, const std::int32_t* origin,
                                    Real* lanes) {
        put(RowDifferences<P>(rows, origin).to(index), lanes);
    }
    static void store_indexed_rows(double* rows, const std::int32_t* index, const Real* lanes) {
        store_rows<P>(rows, index, get(lanes));
    }

    static constexpr SimdProbe<Real> table{
        P::width,       &apply_to,  &compare_these, &sum_of,      &largest_of,          &load_indexed,      &load_row,
        &store_indexed, &store_row, &add_indexed,   &differences, &differences_of_rows, &store_indexed_rows};
};

}  // namespace

template <>
const SimdProbe<float>& simd_probe_instance<isa::LANCET_PROBE_ISA, float>() {
    return Probe<Pack<isa::LANCET_PROBE_ISA, float>>::table;
}

template <>
const SimdProbe<double>& simd_probe_instance<isa::LANCET_PROBE_ISA, double>() {
    return Probe<Pack<isa::LANCET_PROBE_ISA, double>>::table;
}

}  // namespace lancet::kernels::test
