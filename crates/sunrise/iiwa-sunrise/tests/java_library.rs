//! Java library: lists, maps, sets, queues, iterators and builders. The expected texts are the
//! output of a JVM (JDK 17).

use crate::evaluation::{import, joint_targets, refused_import};

/// Class with an order of its objects.
const PART: &str = "static class P implements Comparable<P> { int n; P(int n) { this.n = n; }\n\
    public int compareTo(P o) { return n - o.n; } public String toString() { return \"P\" + n; } }";

const TEXTS: [(&str, &str); 43] = [
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(2, 1, 3));
            for (Integer own : new ArrayList<Integer>(l)) {
                l.remove(own);
                break;
            }
            s = "" + l;
        "#,
        "[1, 3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(3, 1, 2));
            Collections.sort(l);
            s = "" + l;
        "#,
        "[1, 2, 3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(3, 1, 2));
            Collections.sort(l, Collections.reverseOrder());
            s = "" + l;
        "#,
        "[3, 2, 1]",
    ),
    (
        r#"
            List<String> l = new ArrayList<String>(Arrays.asList("b", "a", "Z"));
            Collections.sort(l, new Comparator<String>() {
                public int compare(String x, String y) {
                    return y.compareTo(x);
                }
            });
            s = "" + l;
        "#,
        "[b, a, Z]",
    ),
    (
        r#"
            List<P> l = new ArrayList<P>(Arrays.asList(new P(3), new P(1), new P(2)));
            Collections.sort(l);
            s = "" + l;
        "#,
        "[P1, P2, P3]",
    ),
    (
        r#"
            List<P> l = new ArrayList<P>(Arrays.asList(new P(3), new P(1), new P(2)));
            s = "" + Collections.max(l) + Collections.min(l);
        "#,
        "P3P1",
    ),
    (
        r#"
            P[] l = new P[] {new P(3), new P(1), new P(2)};
            Arrays.sort(l);
            s = "" + l[0] + l[1] + l[2];
        "#,
        "P1P2P3",
    ),
    (
        r"int[] l = new int[] {5, 4, 3, 2}; Arrays.sort(l, 1, 3); s = Arrays.toString(l);",
        "[5, 3, 4, 2]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3, 4));
            Collections.swap(l, 0, 3);
            s = "" + l;
        "#,
        "[4, 2, 3, 1]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3, 4));
            Collections.rotate(l, 1);
            s = "" + l;
            Collections.rotate(l, -3);
            s += l;
        "#,
        "[4, 1, 2, 3][3, 4, 1, 2]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3));
            Collections.fill(l, 7);
            s = "" + l;
        "#,
        "[7, 7, 7]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3));
            l.addAll(1, Arrays.asList(8, 9));
            s = "" + l;
        "#,
        "[1, 8, 9, 2, 3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3, 2));
            s = "" + l.removeAll(Arrays.asList(2)) + l + l.retainAll(Arrays.asList(3)) + l;
        "#,
        "true[1, 3]true[3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(3, 1, 2));
            l.remove(Integer.valueOf(1));
            s = "" + l;
            l.remove(1);
            s += l;
        "#,
        "[3, 2][3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(3, 1, 2));
            Integer boxed = 1;
            int plain = 0;
            l.remove(boxed);
            l.remove(plain);
            s = "" + l;
        "#,
        "[2]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(3, 1, 2));
            l.remove((Object) 2);
            l.remove(l.size() - 1);
            s = "" + l;
        "#,
        "[3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(3, 1, 2));
            l.remove(l.get(1));
            s = "" + l;
            l.remove(l.indexOf(2));
            s += l;
        "#,
        "[3, 2][3]",
    ),
    (
        r#"
            List<String> l = new ArrayList<String>(Arrays.asList("a", "b"));
            s = "" + l.remove("b") + l.remove("c") + l;
        "#,
        "truefalse[a]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3, 4));
            for (Iterator<Integer> i = l.iterator(); i.hasNext();) {
                if (i.next() % 2 == 0) {
                    i.remove();
                }
            }
            s = "" + l;
        "#,
        "[1, 3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3));
            for (ListIterator<Integer> i = l.listIterator(); i.hasNext();) {
                int v = i.next();
                i.set(v * 10);
                if (v == 2) {
                    i.add(25);
                }
            }
            s = "" + l;
        "#,
        "[10, 20, 25, 30]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3));
            ListIterator<Integer> i = l.listIterator(3);
            s = "";
            while (i.hasPrevious()) {
                s += i.previous();
            }
        "#,
        "321",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3, 4, 5));
            l.subList(1, 3).clear();
            s = "" + l;
        "#,
        "[1, 4, 5]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3, 4, 5));
            List<Integer> p = l.subList(1, 4);
            l.set(2, 9);
            p.set(0, 8);
            p.add(7);
            Collections.reverse(p);
            s = "" + l + p + p.size();
        "#,
        "[1, 7, 4, 9, 8, 5][7, 4, 9, 8]4",
    ),
    (
        r#"
            Integer[] a = new Integer[] {3, 1, 2};
            List<Integer> l = Arrays.asList(a);
            Collections.sort(l);
            s = "" + a[0] + a[1] + a[2];
            a[0] = 9;
            s += l;
        "#,
        "123[9, 2, 3]",
    ),
    (
        r#"
            List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2));
            s = "" + l.equals(Arrays.asList(1, 2)) + l.contains(2) + l.lastIndexOf(2)
                + l.containsAll(Arrays.asList(2, 3));
        "#,
        "truetrue1false",
    ),
    (
        r#"
            LinkedList<Integer> q = new LinkedList<Integer>();
            q.add(1);
            q.add(2);
            q.offer(3);
            s = "" + q.peek() + q.poll() + q.peekLast() + q.getFirst();
            q.push(5);
            s += q.pop() + "" + q + q.pollLast() + q;
        "#,
        "11325[2, 3]3[2]",
    ),
    (
        r#"
            Stack<Integer> q = new Stack<Integer>();
            q.push(1);
            q.push(2);
            s = "" + q.peek() + q.pop() + q + q.empty();
        "#,
        "22[1]false",
    ),
    (
        r#"
            ArrayDeque<Integer> q = new ArrayDeque<Integer>();
            q.push(1);
            q.push(2);
            q.addLast(3);
            s = "" + q + q.peek() + q.pop() + q.removeLast() + q;
        "#,
        "[2, 1, 3]223[1]",
    ),
    (
        r#"
            Map<String, Integer> m = new HashMap<String, Integer>();
            m.put("b", 2);
            Map<String, Integer> n = new HashMap<String, Integer>();
            n.put("a", 1);
            n.put("b", 3);
            m.putAll(n);
            s = "" + m + m.size() + m.get("b");
        "#,
        "{a=1, b=3}23",
    ),
    (
        r#"
            Map<String, Integer> m = new TreeMap<String, Integer>();
            m.put("b", 2);
            m.put("a", 1);
            s = "" + m + m.keySet() + m.values() + m.containsValue(2);
        "#,
        "{a=1, b=2}[a, b][1, 2]true",
    ),
    (
        r#"
            Map<String, Integer> m = new LinkedHashMap<String, Integer>();
            m.put("b", 2);
            m.put("a", 1);
            for (Iterator<Map.Entry<String, Integer>> i = m.entrySet().iterator(); i.hasNext();) {
                if (i.next().getValue() == 2) {
                    i.remove();
                }
            }
            s = "" + m;
        "#,
        "{a=1}",
    ),
    (
        r#"
            Map<Integer, String> m = new TreeMap<Integer, String>();
            m.put(2, "b");
            m.put(1, "a");
            Set<Integer> k = m.keySet();
            m.put(3, "c");
            s = "" + k + m.remove(2) + k + m.remove(7);
        "#,
        "[1, 2, 3]b[1, 3]null",
    ),
    (
        r#"
            Set<Integer> m = new TreeSet<Integer>(Arrays.asList(3, 1, 2, 3));
            s = "" + m + m.remove(1) + m.remove(1) + m.add(2) + m.add(5) + m;
            m.retainAll(Arrays.asList(5));
            s += m;
        "#,
        "[1, 2, 3]truefalsefalsetrue[2, 3, 5][5]",
    ),
    (
        r#"
            Set<Integer> m = new HashSet<Integer>(new TreeSet<Integer>(Arrays.asList(3, 1)));
            s = "" + m.size() + new ArrayList<Integer>(m) + m.contains(3);
        "#,
        "2[1, 3]true",
    ),
    (
        r#"
            StringBuilder b = new StringBuilder("abc");
            b.insert(1, 5).append('x').append(1.5);
            s = b.toString() + b.length() + b.indexOf("c");
        "#,
        "a5bcx1.583",
    ),
    (
        r#"
            StringBuilder b = new StringBuilder("abcdef");
            b.reverse().delete(0, 2).replace(0, 1, "XY");
            s = b.toString();
        "#,
        "XYcba",
    ),
    (
        r#"
            StringBuilder b = new StringBuilder("abcdef");
            b.setCharAt(1, 'Z');
            b.setLength(3);
            b.deleteCharAt(0);
            s = b.toString() + b.equals(b) + b.toString().equals("Zc");
        "#,
        "Zctruetrue",
    ),
    (r#"s = "" + "b".compareTo("d") + "ab".compareTo("abcd") + "a".compareTo("a");"#, "-2-20"),
    (
        r#"List<Integer> l = Collections.nCopies(3, 4); s = "" + l + Collections.frequency(l, 4);"#,
        "[4, 4, 4]3",
    ),
    (
        r"
            int[] a = Arrays.copyOfRange(new int[] {1, 2, 3}, 1, 4);
            s = Arrays.toString(a) + Arrays.equals(a, new int[] {2, 3, 0});
        ",
        "[2, 3, 0]true",
    ),
    (
        r#"
            Map<Long, Integer> m = new HashMap<Long, Integer>();
            m.put(1L, 5);
            s = "" + m.get(1L) + m.get(1) + m.containsKey(1L);
        "#,
        "5nulltrue",
    ),
    (
        r#"
            List<Object> l = new ArrayList<Object>();
            l.add(1);
            l.add(1.0);
            s = "" + l.indexOf(1.0) + l.contains(1L);
        "#,
        "1false",
    ),
    (
        r#"
            Object[] a = new ArrayList<Integer>(Arrays.asList(1, 2)).toArray();
            s = "" + a.length + a[1];
        "#,
        "22",
    ),
];

#[test]
fn the_library_agrees_with_a_jvm() {
    let mut wrong = Vec::new();
    for (statements, text) in TEXTS {
        let text = text.replace('"', "\\\"");
        let run = format!(
            "String s; {statements} lbr.move(ptp(s.equals(\"{text}\") ? 0.5 : 0.1, 0, 0, 0, 0, 0, \
             0)); getLogger().info(s);"
        );
        match import(PART, &run) {
            Ok(_) if joint_targets(PART, &run) == [0.5] => {}
            Ok(_) => wrong.push(format!("another text than {text}: {statements}")),
            Err(error) => wrong.push(format!("{error}: {statements}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn unmodelled_calls_make_their_targets_unknown() {
    // Statements, and the value that is used after each.
    let cases = [
        ("l.removeIf(x -> x > System.nanoTime());", "l.size()"),
        ("l.replaceAll(x -> x + (int) System.nanoTime());", "l.get(0)"),
        ("l.sort((x, y) -> x - (int) System.nanoTime());", "l.get(0)"),
        ("m.computeIfAbsent(\"b\", k -> (int) System.nanoTime());", "m.size()"),
        ("Collections.copy(l, Arrays.asList(7));", "l.get(0)"),
        ("Collections.sort(l, String.CASE_INSENSITIVE_ORDER);", "l.get(0)"),
        ("Collections.sort(l, Collections.reverseOrder(null));", "l.get(0)"),
        ("l.remove(unknownIndex());", "l.size()"),
        ("l.add((int) System.nanoTime(), 5);", "l.size()"),
        ("l.set((int) System.nanoTime(), 5);", "l.get(0)"),
        ("l.listIterator().forEachRemaining(null);", "l.size()"),
        ("new Helper().fill(l);", "l.size()"),
        ("Helper.fill(l);", "l.get(0)"),
        ("m.merge(\"a\", 1, null);", "m.get(\"a\")"),
        ("m.keySet().remove(\"a\");", "m.size()"),
        ("m.put(\"\" + System.nanoTime(), 1);", "m.size()"),
        ("m.remove(\"\" + System.nanoTime());", "m.size()"),
        ("b.appendCodePoint(65);", "b.length()"),
        ("b.append(System.nanoTime());", "b.length()"),
        ("b.insert(0, System.nanoTime());", "b.toString().length()"),
        ("a.accumulateAndGet(1, null);", "a.get()"),
        ("Arrays.setAll(f, null);", "f[0]"),
        ("Arrays.parallelPrefix(f, null);", "f[0]"),
    ];
    let begin = "List<Integer> l = new ArrayList<Integer>(Arrays.asList(1, 2, 3)); Map<String, \
        Integer> m = new HashMap<String, Integer>(); m.put(\"a\", 1); StringBuilder b = new \
        StringBuilder(\"ab\"); AtomicInteger a = new AtomicInteger(1); double[] f = new double[3];";
    let mut wrong = Vec::new();
    for (statements, value) in cases {
        let run = format!("{begin} {statements} lbr.move(ptp({value} * 0.1, 0, 0, 0, 0, 0, 0));");
        match import("", &run) {
            Ok(_) => wrong.push(format!("known: {statements} {value}")),
            Err(iiwa_sunrise::ImportError::Refused(_)) => {}
            Err(error) => wrong.push(format!("{error}: {statements}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn code_that_the_library_would_run_is_not_passed_over() {
    let move_it = "lbr.move(ptp(0.1, 0, 0, 0, 0, 0, 0));";
    let list = "List<Integer> l = new ArrayList<Integer>(); l.add(1);";
    let run = format!("{move_it} {list} new Library(l).forEach(x -> lbr.stop());");
    let message = refused_import("", &run);
    assert!(message.reason.contains("may run a lambda expression"), "{}", message.reason);
    let consumer =
        format!("new Consumer<Integer>() {{ public void accept(Integer x) {{ {move_it} }} }}");
    let message =
        refused_import("", &format!("{move_it} {list} new Library(l).forEach({consumer});"));
    assert!(message.reason.contains("may call `accept`"), "{}", message.reason);
    for run in
        [format!("{list} l.forEach({consumer});"), format!("{list} l.forEach(x -> {move_it});")]
    {
        assert_eq!(joint_targets("", &run.replace(";);", ");")), [0.1]);
    }
}

#[test]
fn an_argument_that_is_not_known_chooses_no_method() {
    let members = "double x = 0; void log(int a) { x = 0.1; } void log(String a) { x = 0.2; } void \
        both(Object a) { x = 0.3; }\n\
        void go(int a) { lbr.move(ptp(0.1, 0, 0, 0, 0, 0, 0)); } void go(String a) { }";
    let run = |call: &str| format!("{call} lbr.move(ptp(x, 0, 0, 0, 0, 0, 0));");
    assert_eq!(joint_targets(members, &run("log(1);")), [0.1]);
    assert_eq!(joint_targets(members, &run("both(Camera.find());")), [0.3]);
    let message = refused_import(members, &run("log(Camera.find());"));
    assert!(message.reason.contains("Camera.find"), "{}", message.reason);
    let message = refused_import(members, &run("go(Camera.find());"));
    assert!(message.reason.contains("which of the methods `go`"), "{}", message.reason);
}
