package a.b;

import java.util.*;

@interface Mark { String value() default ""; int[] many() default {}; }

interface Shape extends Comparable<Shape> { double AREA = 0x1.8p1; double area(); }

enum Side {
    LEFT(-1) { @Override int sign() { return -1; } },
    RIGHT(1);

    private final int sign;
    static { System.out.println("\u0041\n\t\"\\\101"); }
    Side(int sign) { this.sign = sign; }
    int sign() { return sign; }
}

@Mark(value = "x", many = {1, 2})
public abstract class Constructs<K, V extends Map<? super K, ?>> implements Shape {
    private static final long BITS = 0xFFL | 0b1010_1010 & ~017 ^ 1_000 << 3 >>> 1 >> 1;
    private float f = .5f + 1e-3F, g[] = new float[3], h[][] = {{1f}, {}};
    char c = '\'', d = 'x';
    transient volatile int n;

    class Inner { int outer = Constructs.this.n; }

    protected <T> T first(final List<? extends T> list, T... others) throws IllegalStateException {
        outer:
        for (int i = 0, j = 10; i < j; i++, --j) {
            for (;;) {
                if (i % 2 == 0) continue outer;
                else if (i > 5) break outer;
                do { n += i; } while (n < 0 && !(n == -1) || n != +2);
                break;
            }
        }
        switch (n) {
            case 0:
            case 1: n = n > 0 ? 1 : n < 0 ? -1 : 0; break;
            default: { n <<= 2; }
        }
        try (Scanner s = new Scanner("1 2")) {
            n = s.nextInt();
        } catch (IllegalArgumentException | NullPointerException e) {
            throw new IllegalStateException("at " + n, e);
        } finally {
            synchronized (this) { assert n >= 0 : "n is " + n; }
        }
        Runnable r = new Runnable() { @Override public void run() { n++; } };
        Comparator<String> byLength = (a, b) -> a.length() - b.length();
        Object o = (Object) list.get(0);
        if (o instanceof String) { o = ((String) o).trim(); }
        Inner inner = this.new Inner();
        int[] copy = new int[] {1, 2, inner.outer}.clone();
        Class<?> k = int[].class;
        return others.length > 0 ? others[0] : Collections.<T>emptyList().get(copy[0]);
    }
}
