package iiwasim.program;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonValue;

import java.math.BigInteger;

/** The value of an input or output: a boolean, a whole number from 0, or a number. */
public final class SignalValue {
    private final Boolean truth;
    private final BigInteger whole;
    private final double number;

    private SignalValue(Boolean truth, BigInteger whole, double number) {
        this.truth = truth;
        this.whole = whole;
        this.number = number;
    }

    public static SignalValue of(boolean value) {
        return new SignalValue(value, null, 0);
    }

    /** A whole number, from 0. */
    public static SignalValue of(long value) {
        return new SignalValue(null, BigInteger.valueOf(value), value);
    }

    public static SignalValue of(double value) {
        return new SignalValue(null, null, value);
    }

    static SignalValue read(Keys keys, String name) throws Refusal {
        JsonValue value = keys.value(name);
        if (!value.isBoolean() && !value.isNumber()) {
            throw keys.wrong(
                "`" + name + "` has to be true, false or a number, not " + Keys.kind(value));
        }
        if (value.isNumber()) {
            keys.number(name);
        }
        return of(value);
    }

    /** The value of a JSON boolean or number. */
    public static SignalValue of(JsonValue value) {
        if (value.isBoolean()) {
            return of(value.asBoolean());
        }
        if (value.toString().matches("0|[1-9][0-9]{0,19}")) {
            BigInteger whole = new BigInteger(value.toString());
            return whole.bitLength() <= 64 ? new SignalValue(null, whole, value.asDouble())
                : of(value.asDouble());
        }
        return of(value.asDouble());
    }

    /** The boolean; null for a number. */
    public Boolean truth() {
        return truth;
    }

    /** The whole number; null for a boolean, a fraction or a negative number. */
    public BigInteger whole() {
        return whole;
    }

    /** The number; 0 for a boolean. */
    public double number() {
        return number;
    }

    /** The value in JSON. */
    public JsonValue json() {
        if (truth != null) {
            return Json.value(truth);
        }
        // Written with decimals, as a whole number is a value of another type.
        return whole != null ? Keys.number(whole) : Json.parse(Double.toString(number));
    }

    @Override
    public String toString() {
        return json().toString();
    }
}
