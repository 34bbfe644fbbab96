(** Terms over real variables: what they mean, where they are defined, their derivatives along vector fields, and matrices of them.

    The definitions of this file are what a theorem about a control system says; [L_correct] and [d_correct] show that [L] and [d]
    are derivatives as analysis defines them. Standard library only. *)

Require Import Reals Lra ZArith.
Require Export PArith List.
Export ListNotations.
Local Open Scope R_scope.

(** * Terms *)

Inductive term :=
| Cst (z : Z) | Pi | Var (v : positive)
| Add (a b : term) | Sub (a b : term) | Mul (a b : term) | Opp (a : term) | Inv (a : term) | Pow (a : term) (n : nat)
| Sin (a : term) | Cos (a : term) | Sqrt (a : term) | Exp (a : term) | Ln (a : term) | Atan (a : term).

Arguments Var v%positive_scope.

(** A state gives each variable a value. *)
Notation state := (positive -> R).

Fixpoint eval (x : state) (e : term) : R :=
  match e with
  | Cst z => IZR z | Pi => PI | Var v => x v
  | Add a b => eval x a + eval x b | Sub a b => eval x a - eval x b | Mul a b => eval x a * eval x b
  | Opp a => - eval x a | Inv a => / eval x a | Pow a n => eval x a ^ n
  | Sin a => sin (eval x a) | Cos a => cos (eval x a) | Sqrt a => sqrt (eval x a)
  | Exp a => exp (eval x a) | Ln a => ln (eval x a) | Atan a => atan (eval x a)
  end.

(** Where a term has a value. *)
Fixpoint defined (x : state) (e : term) : Prop :=
  match e with
  | Cst _ | Pi | Var _ => True
  | Add a b | Sub a b | Mul a b => defined x a /\ defined x b
  | Opp a | Pow a _ | Sin a | Cos a | Exp a | Atan a => defined x a
  | Inv a => defined x a /\ eval x a <> 0
  | Sqrt a => defined x a /\ 0 <= eval x a
  | Ln a => defined x a /\ 0 < eval x a
  end.

(** Where it has a derivative as well: all but roots of nothing. *)
Fixpoint smooth (x : state) (e : term) : Prop :=
  match e with
  | Cst _ | Pi | Var _ => True
  | Add a b | Sub a b | Mul a b => smooth x a /\ smooth x b
  | Opp a | Pow a _ | Sin a | Cos a | Exp a | Atan a => smooth x a
  | Inv a => smooth x a /\ eval x a <> 0
  | Sqrt a | Ln a => smooth x a /\ 0 < eval x a
  end.

(** Two terms are equal at all states at which both have a value. *)
Definition equal (a b : term) := forall x, defined x a -> defined x b -> eval x a = eval x b.

(** * Derivatives *)

(** Sums and products that leave out zeros and ones; derivatives would be large without them. *)
Definition add a b := match a, b with Cst 0, _ => b | _, Cst 0 => a | _, _ => Add a b end.
Definition opp a := match a with Cst 0 => a | Opp b => b | _ => Opp a end.
Definition sub a b := match a, b with _, Cst 0 => a | Cst 0, _ => opp b | _, _ => Sub a b end.
Definition mul a b :=
  match a, b with Cst 0, _ | _, Cst 0 => Cst 0 | Cst 1, _ => b | _, Cst 1 => a | _, _ => Mul a b end.

(** A vector field: the rate of each variable. *)
Notation vector_field := (positive -> term).

(** The derivative of a term along a vector field, by the rules of calculus. *)
Fixpoint L (f : vector_field) (e : term) : term :=
  match e with
  | Cst _ | Pi => Cst 0
  | Var v => f v
  | Add a b => add (L f a) (L f b)
  | Sub a b => sub (L f a) (L f b)
  | Mul a b => add (mul (L f a) b) (mul a (L f b))
  | Opp a => opp (L f a)
  | Inv a => opp (mul (L f a) (Pow (Inv a) 2))
  | Pow a O => Cst 0
  | Pow a (S n) => mul (mul (Cst (Z.of_nat (S n))) (Pow a n)) (L f a)
  | Sin a => mul (Cos a) (L f a)
  | Cos a => opp (mul (Sin a) (L f a))
  | Sqrt a => mul (Inv (Mul (Cst 2) (Sqrt a))) (L f a)
  | Exp a => mul (Exp a) (L f a)
  | Ln a => mul (Inv a) (L f a)
  | Atan a => mul (Inv (Add (Cst 1) (Pow a 2))) (L f a)
  end.

Definition same_variable (y : term) (v : positive) := match y with Var w => Pos.eqb w v | _ => false end.

(** The field of a list of variables and their rates; what is not named stands still. *)
Fixpoint field (rates : list (term * term)) (v : positive) : term :=
  match rates with [] => Cst 0 | (y, e) :: more => if same_variable y v then e else field more v end.

(** The partial derivative by a variable, and the row of those by several. *)
Definition d (y e : term) := L (fun v => if same_variable y v then Cst 1 else Cst 0) e.

(** The Lie bracket [f, g]. *)
Definition bracket (f g : vector_field) : vector_field := fun v => sub (L f (g v)) (L g (f v)).

(** Terms put in for variables. *)
Fixpoint put (s : list (term * term)) (v : positive) : term :=
  match s with [] => Var v | (y, e) :: more => if same_variable y v then e else put more v end.
Fixpoint subst (s : positive -> term) (e : term) : term :=
  match e with
  | Cst _ | Pi => e | Var v => s v
  | Add a b => Add (subst s a) (subst s b) | Sub a b => Sub (subst s a) (subst s b)
  | Mul a b => Mul (subst s a) (subst s b) | Opp a => Opp (subst s a) | Inv a => Inv (subst s a)
  | Pow a n => Pow (subst s a) n | Sin a => Sin (subst s a) | Cos a => Cos (subst s a)
  | Sqrt a => Sqrt (subst s a) | Exp a => Exp (subst s a) | Ln a => Ln (subst s a) | Atan a => Atan (subst s a)
  end.

(** * Matrices, by rows *)

Notation matrix := (list (list term)).
Definition entry_at (row column : nat) (m : matrix) : term := nth column (nth row m []) (Cst 0).
Definition entry (m : matrix) : term := entry_at 0 0 m.
Definition each (f : term -> term) (m : matrix) : matrix := map (map f) m.
Fixpoint zip {A B C} (f : A -> B -> C) (l : list A) (r : list B) : list C :=
  match l, r with a :: l, b :: r => f a b :: zip f l r | _, _ => [] end.
Definition total (l : list term) := fold_right add (Cst 0) l.
Fixpoint transposed (columns : nat) (m : matrix) : matrix :=
  match columns with O => [] | S n => map (hd (Cst 0)) m :: transposed n (map (@tl _) m) end.
Definition transpose (m : matrix) := transposed (length (hd [] m)) m.
Definition plus (m n : matrix) := zip (zip add) m n.
Definition minus (m n : matrix) := zip (zip sub) m n.
Definition times (m n : matrix) := map (fun row => map (fun column => total (zip mul row column)) (transpose n)) m.
Definition beside (m n : matrix) : matrix := zip (@app term) m n.
Definition above (m n : matrix) : matrix := m ++ n.
Definition dot (m n : matrix) := total (zip mul (concat m) (concat n)).
Definition cross2 (m n : matrix) :=
  match concat m, concat n with [a; b], [c; e] => sub (mul a e) (mul b c) | _, _ => Cst 0 end.
Definition cross3 (m n : matrix) : matrix :=
  match concat m, concat n with
  | [a; b; c], [p; q; r] =>
      let v := [sub (mul b r) (mul c q); sub (mul c p) (mul a r); sub (mul a q) (mul b p)] in
      match m with [_] => [v] | _ => map (fun e => [e]) v end
  | _, _ => []
  end.

(** Laplace's expansion along the first row; minors beside zeros are not looked at. *)
Definition without {A} (n : nat) (l : list A) := firstn n l ++ skipn (S n) l.
Fixpoint minor_det (size : nat) (m : matrix) : term :=
  match size, m with
  | S n, row :: rest =>
      fold_right (fun i sum =>
        match nth i row (Cst 0) with
        | Cst 0 => sum
        | e => let product := mul e (minor_det n (map (without i) rest)) in
               if Nat.even i then add product sum else sub sum product
        end) (Cst 0) (seq 0 (S n))
  | _, _ => Cst 1
  end.
Definition det (m : matrix) := minor_det (length m) m.
Definition inverse (m : matrix) : matrix :=
  let n := length m in
  let cofactor i j :=
    let c := minor_det (pred n) (map (without i) (without j m)) in if Nat.even (i + j) then c else opp c in
  map (fun i => map (fun j => mul (cofactor i j) (Inv (det m))) (seq 0 n)) (seq 0 n).

(** The differential of a term: the row of its derivatives by some variables. *)
Definition differential (by_ : list term) (e : term) : matrix := [map (fun y => d y e) by_].
Definition column_of (f : vector_field) (of_ : list term) : matrix := map (fun y => [L f y]) of_.

(** * How they are written *)

Declare Scope term_scope.
Delimit Scope term_scope with term.
Declare Scope condition_scope.
Delimit Scope condition_scope with condition.
Bind Scope term_scope with term.
Definition of_Z (z : Z) := Cst z.
Definition to_Z (e : term) := match e with Cst z => Some z | _ => None end.
Number Notation term of_Z to_Z : term_scope.
Notation "a + b" := (Add a b) : term_scope.
Notation "a - b" := (Sub a b) : term_scope.
Notation "a * b" := (Mul a b) : term_scope.
Notation "a / b" := (Mul a (Inv b)) : term_scope.
Notation "- a" := (Opp a) : term_scope.
Notation "a ^ n" := (Pow a n%nat) : term_scope.
Notation Tan a := (Mul (Sin a) (Inv (Cos a))) (only parsing).
Notation Cot a := (Mul (Cos a) (Inv (Sin a))) (only parsing).
Notation Sec a := (Mul (Cst 1) (Inv (Cos a))) (only parsing).
Notation Csc a := (Mul (Cst 1) (Inv (Sin a))) (only parsing).
Notation Sinh a := (Mul (Sub (Exp a) (Exp (Opp a))) (Inv (Cst 2))) (only parsing).
Notation Cosh a := (Mul (Add (Exp a) (Exp (Opp a))) (Inv (Cst 2))) (only parsing).
Notation Tanh a := (Mul (Sub (Exp a) (Exp (Opp a))) (Inv (Add (Exp a) (Exp (Opp a))))) (only parsing).
Notation Abs a := (Sqrt (Pow a 2)) (only parsing).
Notation Sign a := (Mul a (Inv (Sqrt (Pow a 2)))) (only parsing).
(** The angle of the point (x, y), by half of it; not on the half line on which it jumps. *)
Notation Atan2 y x := (Mul (Cst 2) (Atan (Mul y (Inv (Add (Sqrt (Add (Pow x 2) (Pow y 2))) x))))) (only parsing).
Notation "a 'at' s" := (subst (put s) a) (at level 20, s at level 9) : term_scope.
Notation "a == b" := (equal a%term b%term) (at level 70, no associativity).

(** Matrices of one shape whose entries are equal. *)
Definition equal_matrices (m n : matrix) := Forall2 (Forall2 equal) m n.
Notation "m === n" := (equal_matrices m%list n%list) (at level 70, no associativity).

(** What a claim is made under. *)
Inductive condition := Equal (a b : term) | Differ (a b : term) | Less (a b : term) | AtMost (a b : term).
Definition meets (x : state) (c : condition) : Prop :=
  match c with
  | Equal a b => defined x a /\ defined x b /\ eval x a = eval x b
  | Differ a b => defined x a /\ defined x b /\ eval x a <> eval x b
  | Less a b => defined x a /\ defined x b /\ eval x a < eval x b
  | AtMost a b => defined x a /\ defined x b /\ eval x a <= eval x b
  end.

(** Equal at all states that meet some conditions and at which both have a value. *)
Definition equal_where (conditions : list condition) (a b : term) :=
  forall x, Forall (meets x) conditions -> defined x a -> defined x b -> eval x a = eval x b.
Definition equal_matrices_where conditions (m n : matrix) := Forall2 (Forall2 (equal_where conditions)) m n.
Notation "a == b 'where' c" := (equal_where c%condition a%term b%term) (at level 70, b at next level, no associativity).
Notation "m === n 'where' c" := (equal_matrices_where c%condition m%list n%list) (at level 70, n at next level, no associativity).
Notation "a = b" := (Equal a b) : condition_scope.
Notation "a <> b" := (Differ a b) : condition_scope.
Notation "a < b" := (Less a b) : condition_scope.
Notation "a <= b" := (AtMost a b) : condition_scope.
Notation "a > b" := (Less b a) (only parsing) : condition_scope.
Notation "a >= b" := (AtMost b a) (only parsing) : condition_scope.
Bind Scope condition_scope with condition.

(** * The derivatives are those of analysis *)

Ltac by_cases := repeat match goal with
  | |- context [match ?z with Z0 => _ | Zpos _ => _ | Zneg _ => _ end] => destruct z
  | |- context [match ?p with xI _ => _ | xO _ => _ | xH => _ end] => destruct p
  | |- context [match ?a with Cst _ => _ | _ => _ end] => destruct a
  end.
Lemma add_ok x a b : eval x (add a b) = eval x a + eval x b.
Proof. unfold add; by_cases; cbn [eval]; lra. Qed.
Lemma opp_ok x a : eval x (opp a) = - eval x a.
Proof. unfold opp; by_cases; cbn [eval]; lra. Qed.
Lemma sub_ok x a b : eval x (sub a b) = eval x a - eval x b.
Proof. unfold sub; by_cases; rewrite ?opp_ok; cbn [eval]; lra. Qed.
Lemma mul_ok x a b : eval x (mul a b) = eval x a * eval x b.
Proof. unfold mul; by_cases; cbn [eval]; lra. Qed.

(** The chain rule: along a curve that moves with the field, a term changes at the rate [L f e]. *)
Theorem L_correct (curve : R -> state) (f : vector_field) t :
  (forall v, derivable_pt_lim (fun s => curve s v) t (eval (curve t) (f v))) ->
  forall e, smooth (curve t) e -> derivable_pt_lim (fun s => eval (curve s) e) t (eval (curve t) (L f e)).
Proof.
  intros moves e. set (x := curve t).
  assert (along : forall a g g', derivable_pt_lim (fun s => eval (curve s) a) t (eval x (L f a)) ->
    derivable_pt_lim g (eval x a) g' ->
    derivable_pt_lim (fun s => g (eval (curve s) a)) t (g' * eval x (L f a))).
  { intros a g g' Ha Hg. exact (derivable_pt_lim_comp (fun s => eval (curve s) a) g t _ _ Ha Hg). }
  induction e; cbn [smooth]; intros H; cbn [L].
  - apply derivable_pt_lim_const.
  - apply derivable_pt_lim_const.
  - apply moves.
  - rewrite add_ok. apply (derivable_pt_lim_plus (fun s => eval (curve s) e1) (fun s => eval (curve s) e2)); tauto.
  - rewrite sub_ok. apply (derivable_pt_lim_minus (fun s => eval (curve s) e1) (fun s => eval (curve s) e2)); tauto.
  - rewrite add_ok, !mul_ok.
    apply (derivable_pt_lim_mult (fun s => eval (curve s) e1) (fun s => eval (curve s) e2)); tauto.
  - rewrite opp_ok. apply (derivable_pt_lim_opp (fun s => eval (curve s) e)); tauto.
  - rewrite opp_ok, mul_ok. cbn [eval].
    replace (- (eval x (L f e) * (/ eval x e) ^ 2)) with (- / Rsqr (eval x e) * eval x (L f e))
      by (unfold Rsqr; field; tauto).
    apply (along e Rinv); [tauto|]. destruct H as [_ H].
    replace (- / Rsqr (eval x e)) with ((0 * eval x e - 1 * 1) / Rsqr (eval x e)) by (unfold Rsqr; field; auto).
    apply (derivable_pt_lim_ext (fun y => fct_cte 1 y / id y)); [intro; unfold fct_cte, id, Rdiv; ring|].
    apply (derivable_pt_lim_div (fct_cte 1) id); [apply derivable_pt_lim_const|apply derivable_pt_lim_id|exact H].
  - destruct n as [|n]; [apply derivable_pt_lim_const|]. rewrite !mul_ok. cbn [eval]. rewrite <- INR_IZR_INZ.
    apply (along e (fun y => y ^ S n)); [tauto|]. apply derivable_pt_lim_pow.
  - rewrite mul_ok. apply (along e sin); [tauto|]. apply derivable_pt_lim_sin.
  - rewrite opp_ok, mul_ok. cbn [eval].
    replace (- (sin (eval x e) * eval x (L f e))) with (- sin (eval x e) * eval x (L f e)) by ring.
    apply (along e cos); [tauto|]. apply derivable_pt_lim_cos.
  - rewrite mul_ok. apply (along e sqrt); [tauto|]. apply derivable_pt_lim_sqrt; tauto.
  - rewrite mul_ok. apply (along e exp); [tauto|]. apply derivable_pt_lim_exp.
  - rewrite mul_ok. apply (along e ln); [tauto|]. apply derivable_pt_lim_ln; tauto.
  - rewrite mul_ok. apply (along e atan); [tauto|]. cbn [eval].
    apply derivable_pt_lim_atan.
Qed.

Lemma eval_ext x y e : (forall v, x v = y v) -> eval x e = eval y e.
Proof. intros H; induction e; cbn; congruence. Qed.
Lemma smooth_ext x y e : (forall v, x v = y v) -> smooth x e -> smooth y e.
Proof. intros H; induction e; cbn; auto; try tauto; rewrite (eval_ext x y e H); tauto. Qed.
Lemma defined_ext x y e : (forall v, x v = y v) -> defined x e -> defined y e.
Proof. intros H; induction e; cbn; auto; try tauto; rewrite (eval_ext x y e H); tauto. Qed.

(** The state in which one variable has another value. *)
Definition moved (x : state) v value : state := fun w => if Pos.eqb v w then value else x w.

(** [d] is the partial derivative. *)
Corollary d_correct x v e : smooth x e ->
  derivable_pt_lim (fun s => eval (moved x v s) e) (x v) (eval x (d (Var v) e)).
Proof.
  intros H. assert (E : forall w, moved x v (x v) w = x w).
  { intro w; unfold moved. destruct (Pos.eqb_spec v w); congruence. }
  rewrite <- (eval_ext _ _ _ E). apply (L_correct (moved x v)).
  - intro w. unfold moved, same_variable.
    destruct (Pos.eqb v w); [apply derivable_pt_lim_id|apply derivable_pt_lim_const].
  - eapply smooth_ext; [|exact H]. intro; symmetry; apply E.
Qed.

(** What is put in for variables has their values. *)
Lemma subst_ok x s e : eval x (subst s e) = eval (fun v => eval x (s v)) e.
Proof. induction e; cbn; congruence. Qed.
Lemma defined_subst x s e :
  (forall v, defined x (s v)) -> defined (fun v => eval x (s v)) e -> defined x (subst s e).
Proof. intros H. induction e; cbn; rewrite ?subst_ok; try tauto. intros _; apply H. Qed.
