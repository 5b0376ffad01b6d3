#include "tests/kernels/material/material_probe.hpp"

#include "lancet/kernels/material/corotational.hpp"
#include "lancet/kernels/material/linear.hpp"
#include "lancet/kernels/material/projected_tangent.hpp"
#include "lancet/kernels/material/st_venant_kirchhoff.hpp"

namespace lancet::kernels::test {

namespace {

template <class P>
void store(const Matrix3<P>& a, typename P::Real* destination) {
    for (int entry = 0; entry < 9; ++entry) a.entry[entry / 3][entry % 3].store(destination + entry * P::width);
}

template <class P>
void store(const Symmetric3<P>& a, typename P::Real* destination) {
    const P entries[6] = {a.xx, a.yy, a.zz, a.xy, a.xz, a.yz};
    for (int entry = 0; entry < 6; ++entry) entries[entry].store(destination + entry * P::width);
}

template <class P>
void store(const P (&a)[3], typename P::Real* destination) {
    for (int entry = 0; entry < 3; ++entry) a[entry].store(destination + entry * P::width);
}

template <class P>
struct Probe {
    using Real = typename P::Real;

    static Deformation<P> deformation(const Real* f) {
        const Matrix3<P> gradient = load_matrix<P>(f);
        return {gradient, to_matrix(svd_rotation(gradient))};
    }

    template <template <class> class Material>
    static void evaluate_as(Real lambda_over_mu, const Real* f, Real* energy, Real* stress) {
        const Material<P> law(deformation(f), P(lambda_over_mu));
        law.energy().store(energy);
        store(law.stress(), stress);
    }
    static void evaluate(MaterialModel model, Real lambda_over_mu, const Real* f, Real* energy, Real* stress) {
        switch (model) {
            case MaterialModel::linear:
                return evaluate_as<LinearMaterial>(lambda_over_mu, f, energy, stress);
            case MaterialModel::corotational:
                return evaluate_as<CorotationalMaterial>(lambda_over_mu, f, energy, stress);
            case MaterialModel::st_venant_kirchhoff:
                return evaluate_as<StVenantKirchhoffMaterial>(lambda_over_mu, f, energy, stress);
        }
    }

    template <template <class> class Material>
    static void tangent_as(TangentKind kind, Real lambda_over_mu, const Real* f, const Real* change, Real* product) {
        const Deformation<P> at = deformation(f);
        const Matrix3<P> d = load_matrix<P>(change);
        if constexpr (!Material<P>::is_convex) {
            if (kind == TangentKind::projected) {
                return store(projected_tangent<Material>(at, P(lambda_over_mu)).tangent(d), product);
            }
        }
        const Material<P> law(at, P(lambda_over_mu));
        if constexpr (Material<P>::uses_rotation) {
            if (kind == TangentKind::rotated) return store(law.rotated_tangent(d), product);
        }
        store(law.tangent(d), product);
    }
    static void tangent(MaterialModel model, TangentKind kind, Real lambda_over_mu, const Real* f, const Real* change,
                        Real* product) {
        switch (model) {
            case MaterialModel::linear:
                return tangent_as<LinearMaterial>(kind, lambda_over_mu, f, change, product);
            case MaterialModel::corotational:
                return tangent_as<CorotationalMaterial>(kind, lambda_over_mu, f, change, product);
            case MaterialModel::st_venant_kirchhoff:
                return tangent_as<StVenantKirchhoffMaterial>(kind, lambda_over_mu, f, change, product);
        }
    }

    static void principal(MaterialModel model, Real lambda_over_mu, const Real* stretch, Real* derivatives) {
        const P s[3] = {P::load(stretch), P::load(stretch + P::width), P::load(stretch + 2 * P::width)};
        const PrincipalDerivatives<P> d = model == MaterialModel::corotational
                                              ? CorotationalMaterial<P>::principal(s, P(lambda_over_mu))
                                              : StVenantKirchhoffMaterial<P>::principal(s, P(lambda_over_mu));
        store(d.first, derivatives);
        store(d.second, derivatives + 3 * P::width);
        store(d.flip, derivatives + 9 * P::width);
        store(d.twist, derivatives + 12 * P::width);
    }

    static void decompose(const Real* f, Real* stretch, Real* left, Real* right) {
        const PrincipalStretches<P> d = singular_value_decomposition(load_matrix<P>(f));
        store(d.stretch, stretch);
        store(d.left, left);
        store(d.right, right);
    }

    static void positive(const Real* symmetric, Real* result) {
        P a[6];
        for (int entry = 0; entry < 6; ++entry) a[entry] = P::load(symmetric + entry * P::width);
        store(positive_part(Symmetric3<P>{a[0], a[1], a[2], a[3], a[4], a[5]}), result);
    }

    static constexpr MaterialProbe<Real> table{P::width, &evaluate, &tangent, &principal, &decompose, &positive};
};

}  // namespace

template <>
const MaterialProbe<float>& material_probe_instance<isa::LANCET_PROBE_ISA, float>() {
    return Probe<Pack<isa::LANCET_PROBE_ISA, float>>::table;
}

template <>
const MaterialProbe<double>& material_probe_instance<isa::LANCET_PROBE_ISA, double>() {
    return Probe<Pack<isa::LANCET_PROBE_ISA, double>>::table;
}

}  // namespace lancet::kernels::test
