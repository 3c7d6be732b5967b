package a;
class A { /* Größe */ String größe = "µm"; }
