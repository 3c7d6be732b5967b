package iiwasim.program;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonArray;
import com.eclipsesource.json.JsonObject;
import com.eclipsesource.json.JsonValue;
import com.eclipsesource.json.ParseException;

import java.math.BigInteger;
import java.util.Collections;
import java.util.HashSet;
import java.util.List;
import java.util.Set;

/**
 * The keys of a JSON object, read one by one. Errors name the key and its place.
 *
 * <p>Reading a duplicate key is an error. {@link #refuseOthers()} refuses keys that were not read.
 */
final class Keys {
    private static final BigInteger MAX_U64 = BigInteger.ONE.shiftLeft(64).subtract(BigInteger.ONE);

    private final JsonObject object;
    private final String where;
    private final Set<String> known = new HashSet<String>();
    private final Set<String> twice = new HashSet<String>();

    /**
     * The keys of {@code value}.
     *
     * @param where name of the object in messages, such as {@code motion 1}; empty for the
     *     instruction
     */
    Keys(JsonValue value, String where) throws Refusal {
        this.where = where;
        if (!value.isObject()) {
            throw wrong((where.length() == 0 ? "the instruction has to be" : "it has to be")
                + " an object, not " + kind(value));
        }
        object = value.asObject();
        Set<String> names = new HashSet<String>();
        for (String name : object.names()) {
            if (!names.add(name)) {
                twice.add(name);
            }
        }
    }

    /** Parses a JSON text. */
    static JsonValue parse(String text) throws Refusal {
        try {
            return Json.parse(text);
        } catch (ParseException error) {
            String what = Messages.of(error);
            int at = what.lastIndexOf(" at ");
            if (at >= 0) {
                what = what.substring(0, at);
            }
            throw Refusal.bad(
                "malformed JSON: " + what + ", at line " + error.getLocation().line + ", column "
                + error.getLocation().column);
        } catch (UnsupportedOperationException error) {
            throw Refusal.bad("malformed JSON, at line 1, column 1");
        }
    }

    /** True if the object has the key. */
    boolean has(String name) throws Refusal {
        known.add(name);
        if (twice.contains(name)) {
            throw wrong("the key `" + Messages.excerpt(name) + "` appears twice");
        }
        return object.get(name) != null;
    }

    /** True if the object has the key, with a value other than null. */
    boolean isGiven(String name) throws Refusal {
        return has(name) && !object.get(name).isNull();
    }

    JsonValue value(String name) throws Refusal {
        if (!has(name)) {
            throw wrong("`" + name + "` is missing");
        }
        return object.get(name);
    }

    double number(String name) throws Refusal {
        return numberOf(value(name), name);
    }

    /** A number; null if the key is absent or null. */
    Double numberIfGiven(String name) throws Refusal {
        return isGiven(name) ? Double.valueOf(number(name)) : null;
    }

    double numberOf(JsonValue value, String name) throws Refusal {
        double number = value.isNumber() ? value.asDouble() : Double.NaN;
        if (Double.isNaN(number) || Double.isInfinite(number)) {
            throw wrong("`" + name + "` has to be a number, not " + kind(value));
        }
        return number;
    }

    double[] numbers(String name, int count) throws Refusal {
        List<JsonValue> values = list(name);
        if (values.size() != count) {
            throw wrong("`" + name + "` has " + values.size() + " values; it has to have " + count);
        }
        double[] numbers = new double[count];
        for (int i = 0; i < count; i++) {
            numbers[i] = numberOf(values.get(i), name + "[" + i + "]");
        }
        return numbers;
    }

    /** A whole number from 0 to 2^64 - 1. */
    BigInteger whole(String name) throws Refusal {
        JsonValue value = value(name);
        String text = value.isNumber() ? value.toString() : "";
        if (!text.matches("0|[1-9][0-9]{0,19}") || new BigInteger(text).compareTo(MAX_U64) > 0) {
            throw wrong("`" + name + "` has to be a whole number from 0 to 2^64 - 1, not "
                + kind(value));
        }
        return new BigInteger(text);
    }

    /** A whole number from 0 to {@code max}; null if the key is absent or null. */
    Integer wholeIfGiven(String name, int max) throws Refusal {
        if (!isGiven(name)) {
            return null;
        }
        BigInteger number = whole(name);
        if (number.compareTo(BigInteger.valueOf(max)) > 0) {
            throw wrong("`" + name + "` is " + number + "; it has to be from 0 to " + max);
        }
        return number.intValue();
    }

    String text(String name) throws Refusal {
        JsonValue value = value(name);
        if (!value.isString()) {
            throw wrong("`" + name + "` has to be a text, not " + kind(value));
        }
        return value.asString();
    }

    /** A text; null if the key is absent or null. */
    String textIfGiven(String name) throws Refusal {
        return isGiven(name) ? text(name) : null;
    }

    /** One of the given words; the first one if the key is absent. */
    String word(String name, String... words) throws Refusal {
        if (!has(name)) {
            return words[0];
        }
        String text = text(name);
        for (String word : words) {
            if (word.equals(text)) {
                return word;
            }
        }
        throw wrong("`" + name + "` is `" + Messages.excerpt(text) + "`; known are " + join(words));
    }

    List<JsonValue> list(String name) throws Refusal {
        JsonValue value = value(name);
        if (!value.isArray()) {
            throw wrong("`" + name + "` has to be a list, not " + kind(value));
        }
        JsonArray array = value.asArray();
        return array.values();
    }

    /** The keys of an object. */
    Keys object(String name) throws Refusal {
        return new Keys(
            value(name), where.length() == 0 ? "`" + name + "`" : where + ": `" + name + "`");
    }

    /** The names in an object of objects; empty if the key is absent. */
    List<String> namesIn(String name) throws Refusal {
        if (!has(name)) {
            return Collections.emptyList();
        }
        Keys entries = object(name);
        for (String entry : entries.object.names()) {
            entries.has(entry);
        }
        return entries.object.names();
    }

    /** Refuses keys that were not read, as an unknown key may be a limit. */
    void refuseOthers() throws Refusal {
        for (String name : object.names()) {
            if (!known.contains(name)) {
                throw wrong("unknown key `" + Messages.excerpt(name) + "`");
            }
        }
    }

    /** A refusal with the place of the object. */
    Refusal wrong(String what) {
        return Refusal.bad(where.length() == 0 ? what : where + ": " + what);
    }

    static String join(String[] words) {
        StringBuilder all = new StringBuilder();
        for (String word : words) {
            all.append(all.length() == 0 ? "`" : ", `").append(word).append('`');
        }
        return all.toString();
    }

    /** A whole number as JSON. */
    static JsonValue number(BigInteger number) {
        // The library does not support integers beyond signed 64 bits.
        return number.bitLength() < 64 ? Json.value(number.longValue())
            : Json.parse(number.toString());
    }

    /** Type of a value, for messages. */
    static String kind(JsonValue value) {
        if (value.isString()) {
            return "the text `" + Messages.excerpt(value.asString()) + "`";
        }
        if (value.isArray()) {
            return "a list";
        }
        return value.isObject() ? "an object" : Messages.excerpt(value.toString());
    }
}
