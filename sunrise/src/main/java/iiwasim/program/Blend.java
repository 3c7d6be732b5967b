package iiwasim.program;

/** Size of a blend at a target. Sizes that are not given are null. */
public final class Blend {
    private final Double sunriseRel;
    private final Double cartMm;
    private final Double oriRad;

    private Blend(Double sunriseRel, Double cartMm, Double oriRad) {
        this.sunriseRel = sunriseRel;
        this.cartMm = cartMm;
        this.oriRad = oriRad;
    }

    /** Reads the blend of a point-to-point motion: exactly one size. */
    static Blend ofPtp(Keys keys) throws Refusal {
        Double fraction = keys.has("fraction") ? Double.valueOf(keys.number("fraction")) : null;
        Double rel = keys.has("sunrise_rel") ? Double.valueOf(keys.number("sunrise_rel")) : null;
        Double cart = keys.has("cart_mm") ? Double.valueOf(keys.number("cart_mm")) : null;
        keys.refuseOthers();
        if ((fraction == null ? 0 : 1) + (rel == null ? 0 : 1) + (cart == null ? 0 : 1) != 1) {
            throw keys.wrong("a blend has exactly one of `fraction`, `sunrise_rel` and `cart_mm`");
        }
        check(keys, "fraction", fraction, 0.5);
        check(keys, "sunrise_rel", rel, 1);
        check(keys, "cart_mm", cart, Double.MAX_VALUE);
        // A relative size of 1 in Sunrise is half of a motion.
        return new Blend(fraction == null ? rel : Double.valueOf(2 * fraction), cart, null);
    }

    /** Reads the blend of a TCP path: at least one size. */
    static Blend ofPath(Keys keys) throws Refusal {
        Double cart = keys.numberIfGiven("cart_mm");
        Double ori = keys.numberIfGiven("ori_deg");
        Double rel = keys.numberIfGiven("sunrise_rel");
        keys.refuseOthers();
        if (cart == null && ori == null && rel == null) {
            throw keys.wrong("a blend has at least one of `cart_mm`, `ori_deg` and `sunrise_rel`");
        }
        check(keys, "cart_mm", cart, Double.MAX_VALUE);
        check(keys, "ori_deg", ori, Double.MAX_VALUE);
        check(keys, "sunrise_rel", rel, 1);
        return new Blend(rel, cart, ori == null ? null : Double.valueOf(Math.toRadians(ori)));
    }

    private static void check(Keys keys, String name, Double size, double max) throws Refusal {
        if (size != null && !(size >= 0 && size <= max)) {
            String range = max == Double.MAX_VALUE ? "0 or more" : "from 0 to " + max;
            throw keys.wrong("`" + name + "` is " + size + "; it has to be " + range);
        }
    }

    /** Relative size in Sunrise, 0 to 1; null if not given. */
    public Double sunriseRel() {
        return sunriseRel;
    }

    /** Distance from the target, in mm; null if not given. */
    public Double cartMm() {
        return cartMm;
    }

    /** Angle to the target orientation, in rad; null if not given. */
    public Double oriRad() {
        return oriRad;
    }

    /** True if the blend is large enough to avoid a stop. */
    boolean hasEffect() {
        if (cartMm != null) {
            return cartMm >= 4;
        }
        return sunriseRel == null || sunriseRel >= 0.05;
    }
}
